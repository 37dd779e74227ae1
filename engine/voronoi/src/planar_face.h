#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "planar_cross.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::voronoi {

/// The corners of a face in its plane. Corner 0 is the origin, and the axes are those of tangent_frame.
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

/// The place itself or, if it is outside the face by rounding, a place on the face's boundary. This occurs for sites so
/// close to each other that few digits of their border are accurate.
inline Eigen::Vector2d within_face(const std::array<Eigen::Vector2d, 3>& corners, const Eigen::Vector2d& place) {
  bool inside = true;
  for (std::size_t i = 0; i < 3; ++i)
    inside = inside && cross(corners[(i + 1) % 3] - corners[i], place - corners[i]) >= 0;
  if (inside) return place;
  const Eigen::Vector3d weights = barycentric(corners, place);
  return weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
}

inline double longest_side(const std::array<Eigen::Vector2d, 3>& corners) {
  double longest = 0;
  for (std::size_t i = 0; i < 3; ++i) longest = std::max(longest, (corners[(i + 1) % 3] - corners[i]).norm());
  return longest;
}

}  // namespace supple::voronoi
