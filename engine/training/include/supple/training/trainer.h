#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/neural/network.h"
#include "supple/training/samples.h"

namespace supple::training {

enum class OptimizerKind { soap, adam };
std::string_view to_string(OptimizerKind kind);
/// Throws "training.invalid_option".
OptimizerKind optimizer_of(std::string_view name);

/// The device that holds the tensors of a training. `automatic` means CUDA if LibTorch has such a device, and the CPU
/// otherwise.
enum class DeviceKind { automatic, cpu, cuda };
std::string_view to_string(DeviceKind kind);
/// Throws "training.invalid_option".
DeviceKind device_of(std::string_view name);
/// The device that a training uses on this machine, cpu or cuda. Throws "training.no_device".
DeviceKind usable_device(DeviceKind wanted);

/// The term that each relative error x of a row adds to the loss. With the network's energy Phi and the simulated
/// energy Psi and stress S, the errors are |Phi - Psi| / Psi and |dPhi/dE - S| / |S|. `squared` adds x^2 [Thesis, eq.
/// 4.8]. `robust` adds log(1 + sqrt(x^2 + error_floor^2)). Its slope falls for errors beyond one and below the floor,
/// so that neither rows close to buckling nor rows that are fitted well already dominate.
enum class LossKind { robust, squared };
std::string_view to_string(LossKind kind);
/// Throws "training.invalid_option".
LossKind loss_of(std::string_view name);

/// A symmetry of a family's energy: the design with parameters p has under the strain e = (E_xx, E_yy, 2 E_xy) the same
/// energy as its *image*, the design with parameters `linear` * p + `constant`, under the strain `strain` * e.
struct EnergySymmetry {
  Eigen::Matrix3d strain;
  Eigen::MatrixXd linear;
  Eigen::VectorXd constant;
};

/// The loss of a row is the weighted sum of the losses of its relative errors of energy, of stress, and of its tangent
/// C along a random direction v. Directions are drawn among those with v^T C v = 1.
/// Structures of beams are a hundred times softer along some strains than along others. With directions that are drawn
/// uniformly, errors of the stiff strains would hide those of the soft ones, which determine the stiffness under a
/// load.
struct TrainingOptions {
  neural::NetworkShape shape;  ///< its width must be a multiple of 16
  int epochs = 300;
  int chunk_rows = 13;    ///< rows of one design that share one evaluation of the parameter branch
  int batch_chunks = 10;  ///< number of chunks in one step
  double learning_rate = 5e-3;
  double final_learning_rate = 1e-5;  ///< the rate rises for a few steps and then falls along a cosine to this value
  double max_gradient_norm = 1;       ///< gradients are clipped to this norm
  double weight_decay = 0;            ///< weights shrink in each step by the fraction weight_decay * learning rate
  LossKind loss = LossKind::robust;
  double energy_weight = 1;
  double stress_weight = 1;
  double tangent_weight = 0.1;
  double tangent_begin = 0.2;  ///< fraction of the epochs after which the tangent is part of the loss
  double error_floor = 0.005;  ///< used by the robust loss
  OptimizerKind optimizer = OptimizerKind::soap;
  /// A checkpoint does not record this option. A training may continue on another device, but its numbers then differ
  /// by rounding.
  DeviceKind device = DeviceKind::automatic;
  double min_input_scale = 1;  ///< least factor of strains in a neuron of the first layer, when weights are drawn
  double max_input_scale = 20;
  /// The network with which training begins. It has `shape` and the bounds of the samples. Without it, weights are
  /// drawn with the seed. Its own symmetries are ignored. `describe` gives a sum over its weights, by which a
  /// checkpoint recognizes it.
  std::optional<neural::Network> start;
  /// The tile with `shape.features` features. They are those of `start` if there is one.
  neural::TileGeometry geometry;
  int stiffness_steps = 300;      ///< steps that first fit the stiffness branch to tangents at or near zero strain
  int stiffness_batch = 512;      ///< number of designs in one of these steps
  bool freeze_stiffness = false;  ///< whether the stiffness branch stays as it was fitted
  int patience = 0;               ///< training ends after so many epochs without a better validation; 0 runs all epochs
  int validation_interval = 5;    ///< epochs from one validation to the next
  std::int64_t seed = 1;
  /// The symmetries of the family. Each time that a chunk is used, the identity or a random one of them is applied to
  /// it (data augmentation). A symmetry is applied only if the image of the design lies in the box, or not further from
  /// it than the data, and is none of the held-out designs.
  std::vector<EnergySymmetry> symmetries;
};

/// Throws "training.invalid_option", which names the first option out of its range.
void check(const TrainingOptions& options, const Samples& samples);

/// The options by name, as a model file stores them and as they are compared when a checkpoint is continued.
std::vector<std::pair<std::string, std::string>> describe(const TrainingOptions& options);

/// How well the stiffness branch fits. The error of a design with the simulated tangent C* is the maximum over v of
/// |v^T (L L^T - C*) v| / v^T C* v. It is given for the designs of the fit and for some that were held out of it.
struct StiffnessReport {
  int step = 0;
  std::int64_t designs = 0;  ///< number of designs, including their images by symmetry
  double trained_mean = 0;
  double trained_median = 0;
  double unseen_mean = -1;  ///< error of the held-out designs; negative if there are none
  double unseen_median = -1;
  double seconds = 0;
};

struct EpochReport {
  int epoch = 0;                    ///< counted from 1
  double loss = 0;                  ///< mean over the epoch's rows
  double validation_gradient = -1;  ///< mean relative error; negative if it was not measured
  double validation_energy = -1;
  double validation_stiffness = -1;  ///< median relative error; negative if it was not measured
  double learning_rate = 0;
  double seconds = 0;  ///< duration of the training so far, over all calls
};

struct TrainingResult {
  neural::Network network;  ///< the network with the least validation error
  std::vector<EpochReport> history;
  std::optional<StiffnessReport> stiffness;  ///< report on the stiffness branch if this call fitted it
  int best_epoch = 0;
  DeviceKind device = DeviceKind::cpu;  ///< the device that was used
  bool finished = false;                ///< false if it was interrupted; the same call then continues
};

/// Trains on thread_count() threads or on a GPU. First the stiffness branch is fitted to `rest` or, if that is empty,
/// to the row of least strain of each training design. The branch of `options.start` is fitted only if there is `rest`.
///
/// `checkpoint` (if not empty) is rewritten at the end of an epoch if half a minute has passed or a stop was requested.
/// A call with the same samples, split and options continues from there. On the CPU the result has the same bits as
/// without an interruption. The caller deletes the checkpoint after it has written the model. An interrupted epoch, or
/// an interrupted fit of the stiffness branch, begins anew.
///
/// Throws "training.invalid_option", which names the option, "training.diverged" if the gradient is not finite,
/// "file.unreadable", "file.write_failed", "training.no_device" if CUDA is requested and there is none, and
/// "training.different_options" for a checkpoint of another training.
TrainingResult train(const Samples& samples, const Split& split, const TrainingOptions& options,
                     const std::filesystem::path& checkpoint, const CancellationToken& cancellation,
                     const std::function<void(const EpochReport&)>& report, const std::vector<RestStiffness>& rest = {},
                     const std::function<void(const StiffnessReport&)>& stiffness_report = {});

/// Fits the stiffness branch as `train` does, and writes the initial network and the rows as a file for another trainer
/// (docs/models.md lists its content). Returns false if it was cancelled. Throws what `train` throws.
bool export_training(const std::filesystem::path& path, const Samples& samples, const Split& split,
                     const TrainingOptions& options, const std::vector<RestStiffness>& rest,
                     const CancellationToken& cancellation,
                     const std::function<void(const StiffnessReport&)>& stiffness_report = {});

}  // namespace supple::training
