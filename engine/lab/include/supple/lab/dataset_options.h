#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "supple/dataset/dataset.h"
#include "supple/lab/load_plan.h"
#include "supple/microscale/simulation.h"

namespace supple::lab {

/// What a data set holds, and how exactly it is computed.
struct DatasetOptions {
  std::string family;      ///< e.g. "IH21"
  std::uint64_t seed = 1;  ///< below 2^63
  /// Designs are points of a sequence that does not depend on how many are asked for: `first` goes on where an earlier
  /// data set ended.
  std::int64_t first = 0;
  std::int64_t designs = 100;
  std::int64_t shard = 0;  ///< this one of `shards` parts: designs with index mod shards = shard
  std::int64_t shards = 1;
  /// Widens the family's box of parameters by this share of its width on either side, in [0, 0.5]: a network that is
  /// used up to the border needs data beyond it.
  double box_margin = 0.05;
  /// If not empty, the part of the widened box that the sequence covers instead: more designs where a response changes
  /// fast with the parameters.
  std::vector<double> part_lower;
  std::vector<double> part_upper;
  /// The sequence begins with the 2^k corners (k parameters) of the family's own box or of the part, where errors are
  /// largest.
  bool corners = true;
  /// If not empty, the one design instead of a sequence.
  std::vector<double> parameters;
  LoadPlanOptions loads{};
  microscale::SimulationOptions simulation{};
};

/// Of a data set of stiffnesses at rest: 20,000 designs of a family that is still to be named, a state each, without
/// the effects that a load calls for.
DatasetOptions rest_options();

/// Throws "dataset.invalid_option" (each option named, with its limits) and what tiling::family throws.
void check(const DatasetOptions& options);

/// The settings that decide the content, all of them, with their units; those of a part only where there is one.
dataset::Recipe recipe_of(const DatasetOptions& options);
/// The reverse. Throws "file.unreadable" where a setting is missing or has an unknown value.
DatasetOptions options_of(const dataset::Recipe& recipe, const dataset::Selection& selection);

dataset::Selection selection_of(const DatasetOptions& options);

}  // namespace supple::lab
