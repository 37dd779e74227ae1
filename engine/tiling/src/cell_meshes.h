#pragma once

#include "size_field.h"
#include "torus_mesh.h"

namespace supple::tiling {

// Both take a size field without corners.

/// Meshes one tile of each kind between its outline (beam centre lines) and its holes, and places the copies.
TriangleSoup mesh_by_tiles(const Structure& structure, SizeField size);

/// Meshes a parallelogram of the solid, whatever the tiles: beams are cut only where they leave the parallelogram.
TriangleSoup mesh_by_parallelogram(const Structure& structure, SizeField size);

}  // namespace supple::tiling
