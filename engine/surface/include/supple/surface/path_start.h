#pragma once

#include <Eigen/Core>
#include <limits>

namespace supple::surface {

/// How a shortest path leaves its source.
struct PathStart {
  /// Unit direction of travel in tangent_frame of the source's face; zero where the path has no length. At a vertex,
  /// faces between that face and the path are unfolded the shorter way round.
  Eigen::Vector2d direction = Eigen::Vector2d::Zero();
  /// Of a source on a vertex: the angle of that direction, as VertexCone counts it; NaN elsewhere.
  double angle = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace supple::surface
