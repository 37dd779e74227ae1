#pragma once

#include <optional>

#include "supple/tiling/mesh.h"

namespace supple::bench {

/// The mesh of `from` on the shape of `to`, a structure of the same family at parameters close by: the same triangles,
/// so that what is simulated on it changes smoothly with the parameters. Nodes on the outline keep their place along
/// its side, the displacements of the others (in shares of the lattice) are harmonic on the graph of the sides. None
/// where the two outlines do not have the same corners, or a triangle would turn over.
std::optional<tiling::PeriodicMesh> morphed(const tiling::PeriodicMesh& mesh, const tiling::Structure& from,
                                            const tiling::Structure& to);

}  // namespace supple::bench
