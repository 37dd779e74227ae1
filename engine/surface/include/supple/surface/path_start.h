#pragma once

#include <Eigen/Core>
#include <limits>

namespace supple::surface {

/// The direction in which a shortest path leaves its source.
struct PathStart {
  /// Unit direction of travel in tangent_frame of the source's face; zero if the path has no length. At a vertex, the
  /// faces between that face and the path are unfolded on the side of the vertex with the smaller angle.
  Eigen::Vector2d direction = Eigen::Vector2d::Zero();
  /// If the source is a vertex: the angle of that direction in radians, as VertexCone counts it; else NaN.
  double angle = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace supple::surface
