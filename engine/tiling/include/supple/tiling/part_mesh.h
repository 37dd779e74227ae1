#pragma once

#include <vector>

#include "supple/base/execution.h"
#include "supple/tiling/mesh.h"
#include "supple/tiling/part.h"

namespace supple::tiling {

/// What the mesh of a part is expected to need, before it is made.
struct PartMeshEstimate {
  double nodes = 0;  ///< number of nodes of quadratic triangles
  double bytes = 0;  ///< memory of mesh and simulation, most of which is the factorization of the stiffness
};

/// Estimates the mesh of a solid. It is meant as an upper bound that is rarely exceeded. Beyond `options.max_nodes` it
/// is rough. O(n) for n points of the divided outline, of which there are at most max_nodes.
PartMeshEstimate estimate_part_mesh(const std::vector<SolidFace>& faces, double beam_width, const MeshOptions& options);

/// Meshes the solid of a part, which is not periodic, with quadratic triangles. Their sides have the length that
/// `options` asks for beams of `beam_width` (mm, > 0), and are shorter at re-entrant corners. Every corner of the solid
/// becomes a node.
///
/// The mesh has the form of a periodic one without a triangle across the border of its cell. `lattice` is a rectangle
/// of `part_cell_ratio` times the bounding box, so that the part can become longer without meeting an image of itself.
///
/// `options.region` has no effect. Throws "tiling.mesh_option", "tiling.mesh_too_large" (with the limit and the
/// expected number, before anything is meshed) and "tiling.meshing_failed". If this process has helpers, the mesh is
/// made in one of them, as `mesh_structure` says.
PeriodicMesh mesh_part(const std::vector<SolidFace>& faces, double beam_width, const MeshOptions& options = {},
                       const Execution& execution = {});

/// Ratio of the cell of a part's mesh to the part's bounding box, along either side.
inline constexpr double part_cell_ratio = 4;

}  // namespace supple::tiling
