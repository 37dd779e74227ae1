#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "supple/neural/model.h"
#include "supple/tiling/family.h"
#include "supple/training/samples.h"
#include "supple/training/trainer.h"

namespace supple::training {

/// What the symmetries of the family's tilings make of its energy, each once, without the identity.
std::vector<EnergySymmetry> energy_symmetries(const tiling::Family& family);

struct ModelOptions {
  std::string id;  ///< empty: the family's, in lower case
  SampleOptions samples;
  SplitOptions split;
  TrainingOptions training;  ///< `shape.parameters` and `symmetries` are set from the data
  bool use_symmetry = true;
  bool use_features = false;  ///< the tile's features are inputs; `training.shape.features` and `geometry` are set
  /// Training goes on with its network, whose shape and features hold. It was trained on the same data with the same
  /// split, unless it is foreign.
  std::optional<neural::Model> start;
  /// `start` knows other data of the family: designs that are held out now may have trained it, as far as those data
  /// have them too. Its network goes on under the new data's bounds.
  bool start_is_foreign = false;
};

/// By name, as they are kept with a model: with them and the data the split is made again.
std::vector<std::pair<std::string, std::string>> describe(const ModelOptions& options);
/// The samples and the split of a model that was trained on this data set. Throws "training.different_data" for
/// other data, and "file.unreadable" where the model's options do not hold what is needed.
struct ModelSamples {
  Samples samples;
  Split split;
};
ModelSamples samples_of(const neural::Model& model, const ModelData& data);

/// The model with an energy that has the rotations of its family's tilings exactly: the mean over all of them (see
/// Network::symmetries), with its errors measured anew on the data that it was trained on. Mirror images are left out:
/// they double the cost of an evaluation and gain little. Throws as `samples_of`, and "training.no_symmetry" where the
/// family has no rotation but by half a turn, which no strain feels.
neural::Model symmetrized(neural::Model model, const ModelData& data);

/// The model, whose values stay as they are, with bounds that end where its data end: where designs near a bound have
/// no samples, such as structures that could not be simulated, nobody knows the network's errors. Data that end within
/// 2 % of a bound cover it. Without the error bars, which depend on the bounds. Throws as `samples_of`.
neural::Model narrowed(neural::Model model, const ModelData& data);

struct ModelResult {
  neural::Model model;  ///< with its measured errors, and narrowed
  std::vector<EpochReport> history;
  std::optional<StiffnessReport> stiffness;
  int best_epoch = 0;
  bool finished = false;
};

/// Trains a network on data, as `train`, and measures it on designs and on rows that training has not seen. The
/// data's name and `engine`, the version that trains, go into the provenance. Throws what `train` and `read_samples`
/// throw, "tiling.family_not_found", "training.no_features" as `tile_geometry`, and "training.different_data" where
/// `start` was trained on other data or other designs of them: those that judge must not have trained it.
ModelResult train_model(const ModelData& data, const std::string& data_name, const std::string& engine,
                        const ModelOptions& options, const std::filesystem::path& checkpoint,
                        const CancellationToken& cancellation, const std::function<void(const EpochReport&)>& report,
                        const std::function<void(const StiffnessReport&)>& stiffness_report = {});

}  // namespace supple::training
