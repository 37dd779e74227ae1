#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "supple/dataset/dataset.h"
#include "supple/neural/model.h"
#include "supple/tiling/family.h"

namespace supple::lab {

/// How designs are chosen that a network should learn from.
struct ChoiceOptions {
  int designs = 60;         ///< that are chosen
  int candidates = 2000;    ///< points of a Sobol sequence among which they are chosen
  std::uint64_t seed = 1;   ///< of the sequence
  std::uint32_t first = 0;  ///< its first point, so that each choice sees others
};

/// Chooses designs at which networks that learned from the same data disagree most: their stresses differ where there
/// are too few designs, and where the response bends so that few do not suffice. The networks are compared at the
/// strains of the nearest design of `data`, which are strains that a simulation reaches. A chosen design lowers the
/// disagreement of those around it, so that a choice spreads. Candidates that cannot be built are left out, so that
/// fewer designs may be chosen. Depends on its input alone. Takes candidates x states x members evaluations, about a
/// second for 2,000 x 39 x 3, and needs two members at least.
std::vector<std::vector<double>> choose_designs(const tiling::Family& family, std::span<const neural::Model> members,
                                                std::span<const dataset::Dataset> data, const ChoiceOptions& options);

}  // namespace supple::lab
