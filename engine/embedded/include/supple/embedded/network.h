#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "supple/surface/surface_point.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::embedded {

/// A spring between two points of a network. Its energy is weight * (length - rest_length)^2 [Thesis, eq. 3.13].
struct Spring {
  std::int32_t from = 0;  ///< indices of points
  std::int32_t to = 0;
  double rest_length = 0;  ///< mesh units, not negative
  double weight = 1;       ///< energy per squared mesh unit, not negative
};

/// A triangle of a membrane, whose sides are the shortest paths between three points. Its energy is that of the flat
/// triangle with the same sides [Thesis, section 3.4.3], a good approximation if it is small compared with the
/// surface's radii of curvature.
struct MembraneTriangle {
  std::array<std::int32_t, 3> corners{};  ///< indices of points
  std::array<double, 3> rest_lengths{};   ///< sides (0, 1), (1, 2) and (2, 0) of a triangle, mesh units
};

/// The compressible neo-Hookean material of membranes [Thesis, eq. 3.20], with Lame's constants in three dimensions.
struct MembraneMaterial {
  double youngs_modulus = 1;   ///< energy per cubed mesh unit, positive
  double poisson_ratio = 0.3;  ///< in (-1, 0.5)
  double thickness = 1;        ///< mesh units, positive
};

/// An elastic system on a surface: points that slide on it, springs and triangles between them.
struct Network {
  std::vector<surface::SurfacePoint> points;
  std::vector<Spring> springs;
  std::vector<std::int32_t> fixed_points;  ///< indices of points that stay where they are, in any order
  std::vector<MembraneTriangle> triangles{};
  MembraneMaterial material{};
};

/// The scale of the stiffness, to which tolerances of the gradient are relative: the largest weight of the springs or,
/// if there is a membrane and it is larger, Young's modulus times thickness.
double largest_weight(const Network& network);

/// The network with its points checked by surface::checked_point. Throws Error with a detail for each of the first 20
/// faulty entries ("springs/7/between/1", "fixed_points/0"); its message gives the total. The codes are
/// "network.no_points", "network.spring" (unknown points, one point twice, lengths or weights that are negative or not
/// finite), "network.triangle" (unknown points, one point twice, rest lengths that are not positive and finite or form
/// no triangle with an area), "network.membrane" (a material out of range), "network.fixed_point" (unknown points),
/// "network.unreachable" (springs or triangles between components of the mesh), and "point.*". O(points + springs +
/// triangles).
Network checked_network(const surface::TriangleMesh& mesh, Network network);

}  // namespace supple::embedded
