#pragma once

#include <vector>

#include "supple/tiling/definition_check.h"

namespace supple::tiling {

/// Points of a definition's box: its default, its corners, of which there are at most 64, and `spread` points of a
/// Sobol sequence.
std::vector<std::vector<double>> box_samples(const FamilyDefinition& definition, int spread);

/// Where in the box the tile begins to cross itself, and where its slivers are. The definition must have no faults, and
/// must not cross itself at the default parameters.
std::vector<DefinitionFinding> survey_box(const FamilyDefinition& definition, const Execution& execution);

/// The crossing of the tile at these parameters, if there is one.
std::optional<DefinitionFinding> crossing_at(const FamilyDefinition& definition, const std::vector<double>& parameters);

}  // namespace supple::tiling
