#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "supple/surface/geodesic.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::surface {

/// The motion of a point of the path to first order in the variables, in the unfolded face of one of its segments.
struct Motion {
  std::array<std::int32_t, 3> vertices{-1, -1, -1};
  std::array<double, 3> weights{0, 0, 0};  ///< the point's motion is the sum of the vertices' motions times these
  int end = -1;                            ///< 0 or 1 for an end of the path, -1 for other points
  Eigen::Matrix3d barycentric_jacobian =
      Eigen::Matrix3d::Zero();  ///< derivatives by the end's barycentric coordinates, in columns
};

/// The component along a vector of the motion of a corner of an end's face, which is unfolded about a vertex into
/// another face. It is a linear form in the motions of vertices: a sum of dot products.
struct CornerMotion {
  std::vector<std::pair<std::int32_t, Eigen::Vector3d>> terms;
};

/// The motion of an end of a path, and those of the corners of its face.
struct EndMotion {
  Motion motion;
  std::array<CornerMotion, 3> corners;
};

/// The motion of the first or the second end (0 or 1) of a path in the unfolded `face`. The corners' motions are those
/// along `force`, the gradient by the end's position.
EndMotion end_motion(const TriangleMesh& mesh, const PathPoint& end, int which, std::int32_t face,
                     const Eigen::Vector3d& force);

/// The faces around a vertex of an end's face from its own to `face`.
std::vector<std::int32_t> faces_between(const TriangleMesh& mesh, const SurfacePoint& end, std::int32_t face);

}  // namespace supple::surface
