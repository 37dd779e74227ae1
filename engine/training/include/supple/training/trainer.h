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

/// Where the tensors of a training are. `automatic` means CUDA if LibTorch has a device, and the processor otherwise.
enum class DeviceKind { automatic, cpu, cuda };
std::string_view to_string(DeviceKind kind);
/// Throws "training.invalid_option".
DeviceKind device_of(std::string_view name);
/// The device that a training uses on this machine, cpu or cuda. Throws "training.no_device".
DeviceKind usable_device(DeviceKind wanted);

/// What a row adds to the loss for each of its relative errors x, which are |Phi - Psi| / Psi for the energy and
/// |dPhi/dE - S| / |S| for the stress. `squared` adds the thesis's x^2 (eq. 4.8). `robust` adds log(1 + sqrt(x^2 +
/// error_floor^2)), whose slope falls beyond errors of one and below the floor, so that neither nearly buckled rows nor
/// easy ones dominate.
enum class LossKind { robust, squared };
std::string_view to_string(LossKind kind);
/// Throws "training.invalid_option".
LossKind loss_of(std::string_view name);

/// The energy of the structure at parameters p under the strain e = (E_xx, E_yy, 2 E_xy) is that of the structure at
/// `linear` * p + `constant` under `strain` * e.
struct EnergySymmetry {
  Eigen::Matrix3d strain;
  Eigen::MatrixXd linear;
  Eigen::VectorXd constant;
};

/// Each row adds the losses of its relative errors of energy and stress, and of its tangent along a random direction v,
/// each with its weight. Directions are drawn from those with equal energy, v^T C v = 1. Structures of beams are a
/// hundred times softer along some strains than along others. Along a plain random direction the stiff strains would
/// hide the soft ones, which determine the stiffness under a load.
struct TrainingOptions {
  neural::NetworkShape shape;  ///< its width a multiple of 16
  int epochs = 300;
  int chunk_rows = 13;    ///< rows of one design that share one evaluation of the parameter branch
  int batch_chunks = 10;  ///< number of chunks in one step
  double learning_rate = 5e-3;
  double last_learning_rate = 1e-5;  ///< the rate falls along a cosine, after a short rise
  double largest_gradient = 1;       ///< longer gradients are shortened to this
  double weight_decay = 0;           ///< this times the learning rate is the share by which weights shrink in each step
  LossKind loss = LossKind::robust;
  double energy_weight = 1;
  double stress_weight = 1;
  double tangent_weight = 0.1;
  double tangent_begin = 0.2;  ///< share of the epochs after which the tangent counts
  double error_floor = 0.005;  ///< used by the robust loss
  OptimizerKind optimizer = OptimizerKind::soap;
  /// A checkpoint does not compare this option: a training may go on on another device, although not to the same bits.
  DeviceKind device = DeviceKind::automatic;
  double smallest_input_scale = 1;  ///< smallest scale of strains at the first layer, when weights are drawn
  double largest_input_scale = 20;
  /// The network with which training begins. It has `shape` and the bounds of the samples. Without it, weights are
  /// drawn with the seed. Its own symmetries are left out. `describe` gives a sum over its weights, so that a
  /// checkpoint recognizes it.
  std::optional<neural::Network> start;
  /// The tile with `shape.features` features. They are those of `start` if there is one.
  neural::TileGeometry geometry;
  int stiffness_steps = 300;      ///< steps that first fit the stiffness branch to tangents at rest or next to it
  int stiffness_batch = 512;      ///< number of designs in one of these steps
  bool freeze_stiffness = false;  ///< whether the stiffness branch stays as it was fitted
  int patience = 0;               ///< training ends after so many epochs without a better validation; 0 runs all epochs
  int validation_interval = 5;
  std::int64_t seed = 1;
  /// The symmetries of the family. Each chunk is seen through a random one of them or the identity, provided that the
  /// image of its design lies in the box, or not further from it than the data, and is no design that is held out.
  std::vector<EnergySymmetry> symmetries;
};

/// Throws "training.invalid_option", which names the first option out of its range.
void check(const TrainingOptions& options, const Samples& samples);

/// The options by name, as they are kept with a model and compared when a checkpoint is continued.
std::vector<std::pair<std::string, std::string>> describe(const TrainingOptions& options);

/// How well the stiffness branch fits: max over v of |v^T (L L^T - C*) v| / v^T C* v, which is the error along the
/// worst direction. It is given for designs from which it learns and for some others (negative if there are none).
struct StiffnessReport {
  int step = 0;
  std::int64_t designs = 0;  ///< number of designs, including their images by symmetry
  double trained_mean = 0;
  double trained_median = 0;
  double unseen_mean = -1;
  double unseen_median = -1;
  double seconds = 0;
};

struct EpochReport {
  int epoch = 0;                    ///< counted from 1
  double loss = 0;                  ///< mean over the epoch's rows
  double validation_gradient = -1;  ///< mean relative error; negative if it was not measured
  double validation_energy = -1;
  double validation_stiffness = -1;  ///< median error; negative likewise
  double learning_rate = 0;
  double seconds = 0;  ///< time of training so far, over all runs
};

struct TrainingResult {
  neural::Network network;  ///< the network that was best on the validation rows
  std::vector<EpochReport> history;
  std::optional<StiffnessReport> stiffness;  ///< report on the stiffness branch if this call fitted it
  int best_epoch = 0;
  DeviceKind device = DeviceKind::cpu;  ///< the device that was used
  bool finished = false;                ///< false if it was interrupted: the same call goes on
};

/// Trains on the counted threads or on a GPU. First the stiffness branch is fitted to `rest` or, if that is empty, to
/// the rows next to rest of the training's designs. A network with which training begins keeps its own branch unless
/// there is `rest`. `checkpoint` (if not empty) is rewritten every half minute and when the training is interrupted. A
/// call with the same samples, split and options goes on from there. On the processor it ends with the same bits as a
/// training that was never interrupted. The caller deletes the checkpoint at the end, when the model is written. A fit
/// of the stiffness branch that is interrupted begins anew.
///
/// Throws "training.invalid_option", which names the option, "training.diverged" if a loss is not finite,
/// "file.unreadable", "file.write_failed", "training.no_device" if CUDA is wanted and there is none, and
/// "training.different_options" for a checkpoint of another training.
TrainingResult train(const Samples& samples, const Split& split, const TrainingOptions& options,
                     const std::filesystem::path& checkpoint, const CancellationToken& cancellation,
                     const std::function<void(const EpochReport&)>& report, const std::vector<RestStiffness>& rest = {},
                     const std::function<void(const StiffnessReport&)>& stiffness_report = {});

/// Fits the stiffness branch as `train` does, and writes the network with which training begins and the rows as a file
/// for another trainer (docs/models.md lists what it holds). False if it was cancelled. Throws what `train` throws.
bool export_training(const std::filesystem::path& path, const Samples& samples, const Split& split,
                     const TrainingOptions& options, const std::vector<RestStiffness>& rest,
                     const CancellationToken& cancellation,
                     const std::function<void(const StiffnessReport&)>& stiffness_report = {});

}  // namespace supple::training
