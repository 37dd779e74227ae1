#pragma once

#include "size_field.h"
#include "torus_mesh.h"

namespace supple::tiling {

// Both functions take a size field without corners, and add the corners themselves.

/// Meshes one tile of each kind between its outline (beam centre lines) and its holes, and places the copies.
TriangleSoup mesh_by_tiles(const Structure& structure, SizeField size);

/// Meshes the solid within a parallelogram that represents the cell, regardless of tiles: beams are cut only at the
/// sides of the parallelogram.
TriangleSoup mesh_by_parallelogram(const Structure& structure, SizeField size);

}  // namespace supple::tiling
