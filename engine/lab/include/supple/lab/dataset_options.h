#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "supple/dataset/dataset.h"
#include "supple/lab/load_plan.h"
#include "supple/microscale/simulation.h"

namespace supple::lab {

/// The content of a data set, and how accurately it is computed.
struct DatasetOptions {
  std::string family;      ///< e.g. "IH21"
  std::uint64_t seed = 1;  ///< below 2^63
  /// Designs are points of a sequence that does not depend on how many are asked for. With `first` a data set goes on
  /// where an earlier one ended.
  std::int64_t first = 0;
  std::int64_t designs = 100;
  std::int64_t shard = 0;  ///< the part to be made: designs with index mod shards = shard
  std::int64_t shards = 1;
  /// The share, in [0, 0.5], of its width by which the family's box of parameters is widened on either side, because a
  /// network that is used up to the border needs data beyond it.
  double box_margin = 0.05;
  /// If not empty, the sequence covers only this part of the widened box. It serves to make more designs where a
  /// response changes fast with the parameters.
  std::vector<double> part_lower;
  std::vector<double> part_upper;
  /// Whether the sequence begins with the 2^k corners (for k parameters) of the family's own box or of the part, where
  /// errors are largest.
  bool corners = true;
  /// If not empty, the parameters of one design that is made instead of a sequence.
  std::vector<double> parameters;
  /// If not empty, designs that are made instead of a sequence: the parameters of one after another. Design i has the
  /// loads of place i of the sequence. It serves for designs that something else has chosen, such as a search.
  std::vector<double> list;
  /// If not empty, the direction of the first path of each kind of each listed design, in radians. It serves where what
  /// has chosen a design looked at it along one direction.
  std::vector<double> directions;
  LoadPlanOptions loads{};
  microscale::SimulationOptions simulation{};
};

/// The options of a data set of stiffnesses at rest: 20,000 designs of a family that has yet to be named, with one
/// state each and without the effects that matter only under a load.
DatasetOptions rest_options();

/// Throws "dataset.invalid_option", which names each option with its limits, and what tiling::family throws.
void check(const DatasetOptions& options);

/// All settings that decide the content, with their units. A part, a list and a refinement are included only if the
/// options have them, so that data sets from before these options existed have the same recipe.
dataset::Recipe recipe_of(const DatasetOptions& options);
/// The reverse of recipe_of. Throws "file.unreadable" if a setting is missing or has an unknown value.
DatasetOptions options_of(const dataset::Recipe& recipe, const dataset::Selection& selection);

dataset::Selection selection_of(const DatasetOptions& options);

}  // namespace supple::lab
