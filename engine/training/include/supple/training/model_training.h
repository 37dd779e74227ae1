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

/// How the symmetries of the family's tilings transform its energy. Each is listed once, without the identity.
std::vector<EnergySymmetry> energy_symmetries(const tiling::Family& family);

struct ModelOptions {
  std::string id;  ///< an empty id means that of the family in lower case
  SampleOptions samples;
  SplitOptions split;
  TrainingOptions training;  ///< `shape.parameters` and `symmetries` are set from the data
  bool use_symmetry = true;
  bool use_features = false;  ///< the tile's features are inputs; `training.shape.features` and `geometry` are set
  /// Training goes on with the network of this model, and keeps its shape and features. The model must have been
  /// trained on the same data with the same split, unless it is foreign.
  std::optional<neural::Model> start;
  /// Whether `start` may have been trained on other data of the family. Designs that are held out now may then have
  /// trained it, if those data have them too. Its network goes on under the bounds of the new data.
  bool start_is_foreign = false;
};

/// The options by name, as they are kept with a model. They and the data suffice to make the split again.
std::vector<std::pair<std::string, std::string>> describe(const ModelOptions& options);
/// The samples and the split of a model that was trained on this data set. Throws "training.different_data" for other
/// data, and "file.unreadable" if the model's options lack something that is needed.
struct ModelSamples {
  Samples samples;
  Split split;
  SampleOptions options;  ///< which states are samples
};
ModelSamples samples_of(const neural::Model& model, const ModelData& data);

/// Returns the model with an energy that has the rotations of its family's tilings as exact symmetries. The energy is
/// the mean over all of them (see Network::symmetries), and its errors are measured anew on the data of the training.
/// Mirror images are left out, because they double the cost of an evaluation and gain little. Throws what `samples_of`
/// throws, and "training.no_symmetry" if the family has only the rotation by half a turn, which changes no strain.
neural::Model symmetrized(neural::Model model, const ModelData& data);

/// Returns the model, whose values stay as they are, with bounds that end where its data end. If designs near a bound
/// have no samples, for example because the structures could not be simulated, nothing is known about the network's
/// errors there. Data that end within 2 % of a bound cover it. The error bars are removed, because they depend on the
/// bounds. Throws what `samples_of` throws.
neural::Model narrowed(neural::Model model, const ModelData& data);

struct ModelResult {
  neural::Model model;  ///< the model with its measured errors, and narrowed
  std::vector<EpochReport> history;
  std::optional<StiffnessReport> stiffness;
  int best_epoch = 0;
  bool finished = false;
};

/// Trains a network on data, as `train` does, and measures its errors on designs and on rows that training has not
/// seen. The name of the data and `engine`, the version that trains, go into the provenance. Throws what `train` and
/// `read_samples` throw, "tiling.family_not_found", "training.no_features" as `tile_geometry` does, and
/// "training.different_data" if `start` was trained on other data or on other designs of them: those that judge must
/// not have trained it.
ModelResult train_model(const ModelData& data, const std::string& data_name, const std::string& engine,
                        const ModelOptions& options, const std::filesystem::path& checkpoint,
                        const CancellationToken& cancellation, const std::function<void(const EpochReport&)>& report,
                        const std::function<void(const StiffnessReport&)>& stiffness_report = {});

/// Writes the training of a model as a file for another trainer, `engine/training/pytorch` for example. False if it was
/// cancelled. Throws what `train_model` throws.
bool export_model_training(const ModelData& data, const ModelOptions& options, const std::filesystem::path& path,
                           const CancellationToken& cancellation,
                           const std::function<void(const StiffnessReport&)>& stiffness_report = {});

/// The model of a network that another trainer made of that file: what `train_model` would return if it had trained
/// the network itself. The options that the trainer names replace those of the same name in the provenance, because
/// they say how it was trained. Throws what `train_model` throws, "file.unreadable" if `path` is no such network, and
/// "training.different_options" if it was made of other options or data.
ModelResult import_model_training(const ModelData& data, const std::string& data_name, const std::string& engine,
                                  const ModelOptions& options, const std::filesystem::path& path);

}  // namespace supple::training
