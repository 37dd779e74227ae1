#pragma once

#include "supple/neural/tile_features.h"
#include "supple/tiling/family.h"

namespace supple::training {

/// The tile of a family with its independent features (neural::FeatureKind): lengths and directions of edges, angles at
/// corners, gaps and sides between edges and vertices that are not adjacent, and the density. They are evaluated over
/// the family's parameter box, widened by 5 %. Features that are constant there are left out. Where one feature is a
/// linear function of another, the first is retained. The mean and scale of each feature are those over this box. Takes
/// milliseconds. Throws "training.no_features" unless the family's tile is one polygon whose vertices are affine in the
/// parameters.
neural::TileGeometry tile_geometry(const tiling::Family& family);

}  // namespace supple::training
