#pragma once

#include <cstdint>
#include <vector>

#include "supple/surface/surface_point.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::embedded {

/// A spring between two points of a network: energy weight * (length - rest_length)^2 (thesis eq. 3.13).
struct Spring {
  std::int32_t from = 0;  ///< indices of points
  std::int32_t to = 0;
  double rest_length = 0;  ///< mesh units, not negative
  double weight = 1;       ///< energy per squared mesh unit, not negative
};

/// An elastic network on a surface: points that slide on it and springs between them.
struct Network {
  std::vector<surface::SurfacePoint> points;
  std::vector<Spring> springs;
  std::vector<std::int32_t> fixed_points;  ///< indices of points that stay where they are, in any order
};

/// The network with checked points (surface::checked_point). Throws Error, with one detail for each of the first 20
/// faulty entries ("springs/7/between/1", "fixed_points/0"; the sentence gives the total): "network.no_points",
/// "network.spring" (unknown points, one point twice, lengths or weights that are negative or not finite),
/// "network.fixed_point" (unknown points), "network.unreachable" (springs between components of the mesh), and
/// "point.*". O(points + springs).
Network checked_network(const surface::TriangleMesh& mesh, Network network);

}  // namespace supple::embedded
