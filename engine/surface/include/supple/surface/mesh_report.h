#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "supple/surface/triangle_mesh.h"

namespace supple::surface {

/// Properties of a mesh that a user checks before using it. Lengths are in mesh units.
struct MeshReport {
  std::int64_t vertices = 0;
  std::int64_t faces = 0;
  std::int64_t edges = 0;
  std::int64_t components = 0;
  std::int64_t boundary_loops = 0;
  /// The sum of the genus g of all components, from V - E + F = sum (2 - 2 g) - boundary loops, without unused
  /// vertices.
  std::int64_t genus = 0;
  std::int64_t saddle_vertices = 0;                 ///< interior vertices of total angle above 2 pi (1 + 1e-12)
  Eigen::Vector3d lower = Eigen::Vector3d::Zero();  ///< corner of the bounding box
  Eigen::Vector3d upper = Eigen::Vector3d::Zero();
  double area = 0;
  double edge_min = 0;
  double edge_mean = 0;
  double edge_max = 0;
  double smallest_angle = 0;  ///< radians
  double largest_angle = 0;
  std::vector<std::string> warnings;
};

/// Describes a mesh. O(n).
MeshReport report(const TriangleMesh& mesh, const Execution& execution = {});

}  // namespace supple::surface
