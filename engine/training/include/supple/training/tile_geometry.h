#pragma once

#include "supple/neural/tile_features.h"
#include "supple/tiling/family.h"

namespace supple::training {

/// The family's tile with all features of it that differ: edge lengths, directions, corners, gaps and sides of vertices
/// and edges that are not neighbours, and density, each with its logarithm where it is a length or a share. Of features
/// that are one another's linear functions all over the box, widened by 5 %, the first is kept, and none that is
/// constant; mean and scale are those over this box. Milliseconds. Throws "training.no_features" where the family's
/// tile is not one polygon whose vertices are affine in the parameters.
neural::TileGeometry tile_geometry(const tiling::Family& family);

}  // namespace supple::training
