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

/// The symmetries of the family's energy that follow from those of its tilings. Each is listed once, without the
/// identity.
std::vector<EnergySymmetry> energy_symmetries(const tiling::Family& family);

struct ModelOptions {
  std::string id;  ///< id of the model; if empty, the family's name in lower case
  SampleOptions samples;
  SplitOptions split;
  TrainingOptions training;  ///< `shape.parameters` and `symmetries` are set from the data
  bool use_symmetry = true;
  bool use_features = false;  ///< the tile's features are inputs; `training.shape.features` and `geometry` are set
  /// The model whose network is trained further, with its shape and features. It must have been trained on the same
  /// data with the same split, unless it is foreign.
  std::optional<neural::Model> start;
  /// Whether `start` may have been trained on other data of the family. Those data may contain designs that are held
  /// out now, and the errors on these are then too small. Its network gets the parameter bounds of the new data.
  bool start_is_foreign = false;
};

/// The options by name, as a model file stores them. They and the data determine the split.
std::vector<std::pair<std::string, std::string>> describe(const ModelOptions& options);
/// The samples and the split with which a model was trained.
struct ModelSamples {
  Samples samples;
  Split split;
  SampleOptions options;  ///< the range of energies of the samples
};
/// Makes the samples and the split of a model again, from the data on which it was trained. Throws
/// "training.different_data" for other data, and "file.unreadable" if the model's options lack one that is needed.
ModelSamples samples_of(const neural::Model& model, const ModelData& data);

/// Returns the model with an energy that has the rotations of its family's tilings as exact symmetries. The energy is
/// the mean over all of them (see Network::symmetries), and its errors are measured anew on the data of the training.
/// Reflections are left out, because they double the cost of an evaluation and gain little. Throws what `samples_of`
/// throws, and "training.no_symmetry" if the family has only the rotation by half a turn, which changes no strain.
neural::Model symmetrized(neural::Model model, const ModelData& data);

/// Returns the model with parameter bounds that are narrowed to the range of its data; its values do not change. Where
/// designs near a bound have no samples, for example because the structures could not be simulated, the errors of the
/// network are not known. A bound stays if the data reach to within 2 % of the width of the range. The error bars are
/// removed, because they depend on the bounds. Throws what `samples_of` throws.
neural::Model narrowed(neural::Model model, const ModelData& data);

struct ModelResult {
  neural::Model model;  ///< the narrowed model with its measured errors; empty unless `finished`
  std::vector<EpochReport> history;
  std::optional<StiffnessReport> stiffness;
  int best_epoch = 0;
  bool finished = false;
};

/// Trains a network on data, as `train` does, and measures its errors on held-out designs and on held-out rows. The
/// name of the data and `engine`, the version that trains, go into the provenance. Throws what `train` and
/// `read_samples` throw, "tiling.family_not_found", and "training.no_features" as `tile_geometry` does. Throws
/// "training.different_data" if `start` was trained on other data or with another split, because it must not have been
/// trained on designs that are held out now.
ModelResult train_model(const ModelData& data, const std::string& data_name, const std::string& engine,
                        const ModelOptions& options, const std::filesystem::path& checkpoint,
                        const CancellationToken& cancellation, const std::function<void(const EpochReport&)>& report,
                        const std::function<void(const StiffnessReport&)>& stiffness_report = {});

/// Writes the training of a model as a file for another trainer, for example `engine/training/pytorch`. Returns false
/// if it was cancelled. Throws what `train_model` throws.
bool export_model_training(const ModelData& data, const ModelOptions& options, const std::filesystem::path& path,
                           const CancellationToken& cancellation,
                           const std::function<void(const StiffnessReport&)>& stiffness_report = {});

/// The model of a network that another trainer has trained on an exported file: what `train_model` would return if it
/// had trained the network itself. The options that the trainer has recorded replace those of the same name in the
/// provenance, because they say how the network was trained. Throws what `train_model` throws, "file.unreadable" if
/// `path` is no trained network, and "training.different_options" if it was exported with other options or data.
ModelResult import_model_training(const ModelData& data, const std::string& data_name, const std::string& engine,
                                  const ModelOptions& options, const std::filesystem::path& path);

}  // namespace supple::training
