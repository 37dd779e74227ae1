#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>

#include "supple/surface/triangle_mesh.h"

namespace supple::voronoi {

/// A face in its plane: corner 0 at the origin, the axes those of tangent_frame.
inline std::array<Eigen::Vector2d, 3> planar_corners(const surface::TriangleMesh& mesh, std::int32_t face) {
  const surface::Triangle& corners = mesh.faces()[static_cast<std::size_t>(face)];
  const auto& p = mesh.positions();
  const Eigen::Vector3d along = p[static_cast<std::size_t>(corners[1])] - p[static_cast<std::size_t>(corners[0])];
  const Eigen::Vector3d to_apex = p[static_cast<std::size_t>(corners[2])] - p[static_cast<std::size_t>(corners[0])];
  const double length = along.norm();
  return {Eigen::Vector2d(0, 0), Eigen::Vector2d(length, 0),
          Eigen::Vector2d(along.dot(to_apex), along.cross(to_apex).norm()) / length};
}

/// The barycentric coordinates of a point of a face, given its planar corners.
inline Eigen::Vector3d barycentric(const std::array<Eigen::Vector2d, 3>& corners, const Eigen::Vector2d& point) {
  // The third corner alone has a height over the first side.
  const double c = point.y() / corners[2].y();
  const double b = (point.x() - c * corners[2].x()) / corners[1].x();
  Eigen::Vector3d result(1 - b - c, b, c);
  result = result.cwiseMax(0.0);
  return result / result.sum();
}

}  // namespace supple::voronoi
