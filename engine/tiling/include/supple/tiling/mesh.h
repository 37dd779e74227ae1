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
  int cells_second = 1;   ///< cells of the tiling along the second translation
  double mesh_size = 0;   ///< target length of a side away from corners, mm
  double beam_width = 0;  ///< mm

  double cell_area() const;   ///< area of the whole patch, including holes, mm^2
  double solid_area() const;  ///< area covered by material, mm^2
  /// Rest position of node k of triangle t.
  Eigen::Vector2d corner(int t, int k) const;
};

/// The region that gmsh meshes at a time.
enum class Region {
  automatic,  ///< by tile; if a triangle has an angle below 20 degrees, the better of tile and cell
  tile,  ///< each kind of tile once, between its outline (the beams' centre lines) and its holes; it is then copied
  cell   ///< a parallelogram of the solid: sides of triangles need not follow the beams' centre lines
};

struct MeshOptions {
  /// Length of a triangle's side divided by the beam width, > 0. The defaults of this and of `corner_size` keep the
  /// error of the stress within 1 % (docs/bench/simulations.md). Published data used 1/3 and 1.
  double mesh_size = default_mesh_size;
  /// Size at re-entrant corners of the solid divided by the size elsewhere, from 0.001 to 1. 1 gives a uniform mesh.
  /// Grading acts within half a beam width of corners where the hole's angle is below 165 degrees.
  double corner_size = 0.1;
  /// Structures whose tiles cross themselves are meshed by cells in any case.
  Region region = Region::automatic;
  /// Upper limit of the number of nodes.
  int max_nodes = 2'000'000;
};

/// Meshes one cell. When it is meshed by tiles, every tile of a kind has the same mesh, so that the symmetries that map
/// tiles to other tiles hold exactly. When it is meshed by cells, the parallelogram of the shortest translations is cut
/// where the cuts leave the best angles and lengths.
///
/// Throws "tiling.mesh_option" (which names an option out of range), "tiling.meshing_failed" (with gmsh's message),
/// "tiling.mesh_not_periodic" (sides of tiles do not match) and "tiling.mesh_too_large" (with the limit and an
/// estimate). Several threads may call it. If this process has helpers (`helper_processes`), the mesh is made in one of
/// them: a stop request ends it at once, and what `HelperProcesses` throws is thrown. Otherwise calls wait for each
/// other, because gmsh has one owner, and a stop request is noticed when gmsh has ended. Equal input gives equal meshes
/// in helpers, bit by bit. Without helpers, meshes of a few structures, such as ones with triangles of equal size by
/// symmetry, depend on the addresses in memory and thus on what the process did before.
PeriodicMesh mesh_structure(const Structure& structure, const MeshOptions& options = {},
                            const Execution& execution = {});

/// The same mesh over first x second cells. Both numbers lie between 1 and 100, otherwise "tiling.mesh_option" is
/// thrown. Node i of the copy (a, b) is node i + n (a + first b), where n is the number of nodes of `mesh`.
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
