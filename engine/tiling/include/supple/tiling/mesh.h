#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "supple/base/execution.h"
#include "supple/tiling/structure.h"

namespace supple::tiling {

/// A multiple of the patch's two translations.
struct LatticeShift {
  std::int8_t first = 0;
  std::int8_t second = 0;
  bool operator==(const LatticeShift&) const = default;
};

/// Quadratic triangles with straight sides that tile the solid part of a periodic patch, wrapped on a torus: nodes on
/// opposite sides of the patch are one node, so that periodicity holds by construction.
///
/// Node k of triangle t lies at rest at nodes.col(triangles[t][k]) + lattice * shifts[t][k]. Nodes 0, 1, 2 are the
/// corners, counterclockwise; 3, 4, 5 the midpoints of the sides 01, 12, 20.
struct PeriodicMesh {
  Eigen::Matrix2d lattice;  ///< columns: the translations of the patch, mm
  Eigen::Matrix2Xd nodes;   ///< rest positions, mm
  std::vector<std::array<int, 6>> triangles;
  std::vector<std::array<LatticeShift, 6>> shifts;
  /// Sides on the outline of a hole: triangle and side (0: 01, 1: 12, 2: 20). Seen along the side's direction the
  /// material lies on the left.
  struct Side {
    int triangle = 0;
    int side = 0;
  };
  std::vector<Side> outline;
  int cells_first = 1;    ///< cells of the tiling along the first translation
  int cells_second = 1;   ///< and along the second
  double mesh_size = 0;   ///< target length of a side away from corners, mm
  double beam_width = 0;  ///< mm

  double cell_area() const;   ///< of the whole patch, holes included, mm^2
  double solid_area() const;  ///< mm^2
  /// Rest position of node k of triangle t.
  Eigen::Vector2d corner(int t, int k) const;
};

/// What gmsh is given at a time.
enum class Region {
  automatic,  ///< tile; if a triangle has an angle below 20 degrees, the better of tile and cell
  tile,  ///< a tile between its outline (the beams' centre lines) and its holes, once for each kind, and placed copies
  cell   ///< a parallelogram of the solid: sides of triangles need not follow the beams' centre lines
};

struct MeshOptions {
  /// Length of a side divided by the beam width, > 0. The defaults of this and of `corner_size` keep stress within 1 %
  /// (docs/bench/simulations-refinement.md); published data used 1/3 and 1.
  double mesh_size = 0.5;
  /// Size at re-entrant corners of the solid divided by the size elsewhere, from 0.001 to 1; 1 for a uniform mesh.
  /// Grading acts within half a beam width of corners where the hole's angle is below 165 degrees.
  double corner_size = 0.1;
  /// Structures whose tiles cross themselves are meshed by cells in any case.
  Region region = Region::automatic;
  /// Upper limit of the number of nodes.
  int max_nodes = 2'000'000;
};

/// Meshes one cell. By tiles, every tile of a kind has the same mesh, so that the symmetries that carry tiles to other
/// tiles hold exactly. By cells, the parallelogram of the shortest translations is cut where the cuts leave the best
/// angles and lengths. Deterministic.
/// Throws "tiling.mesh_option" (an option out of range, named), "tiling.meshing_failed" (gmsh's message),
/// "tiling.mesh_not_periodic" (sides of tiles that do not match), "tiling.mesh_too_large" (limit and estimate).
/// Safe to call from several threads. Where this process has helpers (`helper_processes`), the mesh is made there, a
/// stop ends it at once, and what `HelperProcesses` throws is thrown; else gmsh has one owner, calls wait for each
/// other, and a stop is noticed once gmsh has ended. Both give the same mesh, bit by bit.
PeriodicMesh mesh_structure(const Structure& structure, const MeshOptions& options = {},
                            const Execution& execution = {});

/// The same mesh over first x second cells (both 1 to 100, else "tiling.mesh_option"). Node i of the copy (a, b) is
/// node i + n (a + first b), n the number of nodes of `mesh`.
PeriodicMesh repeat(const PeriodicMesh& mesh, int first, int second);

struct MeshStatistics {
  int nodes = 0;
  int triangles = 0;
  double smallest_angle = 0;    ///< rad
  double shortest_side = 0;     ///< mm
  double longest_side = 0;      ///< mm
  double relative_density = 0;  ///< solid area / cell area
};
MeshStatistics statistics(const PeriodicMesh& mesh);

}  // namespace supple::tiling
