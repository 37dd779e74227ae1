#pragma once

#include <cstddef>
#include <vector>

#include "supple/tiling/family_definition.h"

namespace supple::tiling {

/// Index of each edge's first point in the outline that `tiling_at` draws, and the number of points at the end. It does
/// not depend on the parameters.
std::vector<std::size_t> edge_starts(const FamilyDefinition& definition);

}  // namespace supple::tiling
