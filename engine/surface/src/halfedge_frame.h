#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "supple/surface/triangle_mesh.h"
#include "triangle_area.h"

namespace supple::surface {

/// Orthonormal axes in the plane of h's face: along h, and perpendicular to h into the face.
inline Eigen::Matrix<double, 3, 2> halfedge_frame(const TriangleMesh& mesh, std::int32_t h) {
  const auto& p = mesh.positions();
  const Eigen::Vector3d& tail = p[mesh.tail(h)];
  const Eigen::Vector3d along = (p[mesh.head(h)] - tail).normalized();
  const Eigen::Vector3d normal =
      doubled_area(tail, p[mesh.head(h)], p[mesh.tail(TriangleMesh::previous(h))]).normalized();
  Eigen::Matrix<double, 3, 2> frame;
  frame << along, normal.cross(along);
  return frame;
}

}  // namespace supple::surface
