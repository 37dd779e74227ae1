#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "supple/dataset/dataset.h"
#include "supple/lab/load_plan.h"
#include "supple/microscale/simulation.h"
#include "supple/tiling/family.h"

namespace supple::lab {

/// The content of a data set, and how accurately it is computed.
struct DatasetOptions {
  std::string family;  ///< e.g. "IH21"
  /// A family of one's own with the id `family`, which has a definition; null for a shipped family.
  std::shared_ptr<const tiling::Family> own_family;
  std::uint64_t seed = 1;  ///< below 2^63
  /// Index of the first design in the sequence of designs. The sequence does not depend on the number of designs, so
  /// that a data set can continue where an earlier one ended.
  std::int64_t first = 0;
  std::int64_t designs = 100;
  std::int64_t shard = 0;  ///< only designs with index mod shards = shard are made
  std::int64_t shards = 1;
  /// The family's box of parameters is widened on either side by this fraction, in [0, 0.5], of its width. A network
  /// that is used up to the bounds needs data beyond them.
  double box_margin = 0.05;
  /// If not empty, the sequence covers only this part of the widened box. More designs are useful where the response
  /// changes fast with the parameters.
  std::vector<double> part_lower;
  std::vector<double> part_upper;
  /// Whether the sequence begins with the 2^k corners (for k parameters) of the family's box, which is not widened, or
  /// of the part. Networks err most there.
  bool corners = true;
  /// If not empty, the parameters of one design that is made instead of a sequence.
  std::vector<double> parameters;
  /// If not empty, the designs that are made instead of a sequence, for example those that a search has found. It has
  /// the parameters of the first design, then those of the second, and so on. Design i has the loads of index i of the
  /// sequence.
  std::vector<double> list;
  /// If not empty, the direction of the first path of each kind of load, in radians, for each listed design. It is for
  /// designs that were found for a load along one direction.
  std::vector<double> directions;
  LoadPlanOptions loads{};
  microscale::SimulationOptions simulation{};
};

/// The options of a data set of stiffnesses at rest: 20,000 designs with one state each, which is undeformed. Contact,
/// patches and buckling are off, because they matter under a load only. The caller sets the family.
DatasetOptions rest_options();

/// The family whose designs are simulated. Throws what tiling::family throws.
const tiling::Family& family_of(const DatasetOptions& options);

/// Throws "dataset.invalid_option", which names each option with its limits, and what tiling::family throws.
void check(const DatasetOptions& options);

/// All settings that decide the content, with their units. A part, a list, a refinement and the definition of a family
/// of one's own are included only if the options have them, so that data sets from before these options existed have
/// the same recipe.
dataset::Recipe recipe_of(const DatasetOptions& options);
/// The options that have this recipe and selection: the inverse of recipe_of and selection_of. Throws "file.unreadable"
/// if a setting is missing or has an unknown value.
DatasetOptions options_of(const dataset::Recipe& recipe, const dataset::Selection& selection);

dataset::Selection selection_of(const DatasetOptions& options);

}  // namespace supple::lab
