#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "supple/base/execution.h"

namespace supple::meshing {

using SurfaceTriangle = std::array<std::int32_t, 3>;
using Tetrahedron = std::array<std::int32_t, 4>;

/// Linear tetrahedra inside a closed surface.
struct TetrahedralMesh {
  std::vector<Eigen::Vector3d> nodes;     ///< first the surface's vertices in their order, then those inside
  std::vector<Tetrahedron> tetrahedra{};  ///< positive: (b - a, c - a, d - a) is a right-handed frame
  std::int32_t surface_vertices = 0;      ///< number of nodes that are vertices of the surface

  /// The sum of the volumes of the tetrahedra.
  double volume() const;
};

/// The volume of a tetrahedron, one sixth of det(b - a, c - a, d - a). It is negative if the tetrahedron is inside out.
double tetrahedron_volume(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                          const Eigen::Vector3d& d);

struct FillOptions {
  /// The wanted length of edges inside, in the unit of the positions. 0 means the mean edge of the surface. Lengths far
  /// below those of the surface are not reached: its triangles stay, and so do the tetrahedra that stand on large
  /// triangles.
  double element_size = 0;
  /// The growth of the wanted length per length away from finer parts of the surface; positive. Greater values give
  /// fewer and less regular tetrahedra.
  double grading = 0.5;
  std::int64_t max_tetrahedra = 2'000'000;
};

/// Fills a closed surface with tetrahedra by gmsh's Delaunay refinement, followed by its optimization of bad elements.
///
/// The surface stays as it is: node i is vertex i, bit by bit, and every triangle is the face of exactly one
/// tetrahedron. Vertices that no triangle uses stay nodes that belong to no tetrahedron. Each of several components is
/// a solid, or a cavity if it lies inside an odd number of others. The orientation of the triangles does not matter, as
/// long as neighbours agree. The same input gives the same mesh, bit by bit.
/// A surface that is moved, turned, scaled or numbered in another way gets the same tetrahedra, which follow it: inner
/// nodes agree to 1e-9 of its size. This needs vertices that can be distinguished: a surface with symmetries may get
/// another one of the fillings that its symmetries lead to when it is turned, but not when it is numbered in another
/// way.
///
/// If this process has helpers (`helper_processes`), gmsh runs in them: several fillings run at the same time, a stop
/// request ends one at once, and what `HelperProcesses` throws is thrown. Otherwise the call waits for other users of
/// gmsh, and a stop request is followed when the next tetrahedra are made. Progress is reported before and after,
/// because gmsh reports none. Takes about 25 us for each tetrahedron.
///
/// Throws Error
/// - "solid.open_surface": edges without two triangles that agree about their direction, with one detail for each of
///   the first 20 ("edge 3 8");
/// - "solid.too_many_elements": more than `max_tetrahedra`, which is predicted from the volume if possible; the detail
///   "element_size" gives limit and number;
/// - "solid.not_filled": the surface crosses or touches itself, or encloses nothing; the detail "surface" is gmsh's
///   message.
/// Throws std::invalid_argument for an option out of range and for indices of no vertex.
TetrahedralMesh fill(std::span<const Eigen::Vector3d> positions, std::span<const SurfaceTriangle> faces,
                     const FillOptions& options = {}, const Execution& execution = {});

}  // namespace supple::meshing
