#pragma once

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "supple/surface/surface_point.h"

namespace supple::testing {

/// The point of the surface nearest to `p`, with which tests can give points by their positions in space. O(faces).
inline surface::SurfacePoint nearest_point(const surface::TriangleMesh& mesh, const Eigen::Vector3d& p) {
  surface::SurfacePoint best;
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](std::int32_t f, const Eigen::Vector3d& barycentric) {
    const surface::SurfacePoint point{FaceId{f}, barycentric};
    const double distance = (position(mesh, point) - p).norm();
    if (distance < least) {
      least = distance;
      best = point;
    }
  };
  for (std::int32_t f = 0; f < mesh.face_count(); ++f) {
    const auto& face = mesh.faces()[f];
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      const Eigen::Vector3d side = mesh.positions()[face[j]] - mesh.positions()[face[i]];
      const double t = std::clamp(side.dot(p - mesh.positions()[face[i]]) / side.squaredNorm(), 0.0, 1.0);
      Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
      barycentric[i] = 1 - t;
      barycentric[j] = t;
      consider(f, barycentric);
    }
    Eigen::Matrix<double, 3, 2> sides;
    sides << mesh.positions()[face[1]] - mesh.positions()[face[0]],
        mesh.positions()[face[2]] - mesh.positions()[face[0]];
    const Eigen::Vector2d st =
        (sides.transpose() * sides).inverse() * (sides.transpose() * (p - mesh.positions()[face[0]]));
    const Eigen::Vector3d barycentric(1 - st.sum(), st[0], st[1]);
    if (barycentric.minCoeff() > 0) consider(f, barycentric);
  }
  return best;
}

}  // namespace supple::testing
