#pragma once

#include <vector>

#include "supple/tiling/definition_check.h"

namespace supple::tiling {

/// Faults that can be found without drawing a tiling: fields out of range, indices of nothing, what is unused, and
/// expressions that become too large within the box. Without any the tiling can be drawn.
std::vector<DefinitionFinding> field_faults(const FamilyDefinition& definition);

}  // namespace supple::tiling
