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

/// Where the tensors of a training are: `automatic` is CUDA where LibTorch has a device, the processor elsewhere.
enum class DeviceKind { automatic, cpu, cuda };
std::string_view to_string(DeviceKind kind);
/// Throws "training.invalid_option".
DeviceKind device_of(std::string_view name);
/// The one that a training takes on this machine, cpu or cuda. Throws "training.no_device".
DeviceKind usable_device(DeviceKind wanted);

/// What a row adds to the loss of its relative errors x of energy, |Phi - Psi| / Psi, and stress, |dPhi/dE - S| / |S|:
/// `squared` the thesis's x^2 (eq. 4.8); `robust` log(1 + sqrt(x^2 + error_floor^2)), whose slope falls beyond errors
/// of one and below the floor, so that neither nearly buckled rows nor easy ones decide alone.
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
/// each with its weight. Directions are drawn from those that cost alike, v^T C v = 1: structures of beams are a
/// hundred times softer along some strains than along others, and along a plain random direction the stiff ones hide
/// the soft, which rule the stiffness under a load.
struct TrainingOptions {
  neural::NetworkShape shape;  ///< its width a multiple of 16
  int epochs = 300;
  int chunk_rows = 13;    ///< rows of one design that go together; its parameter branch is evaluated once for them
  int batch_chunks = 10;  ///< chunks of one step
  double learning_rate = 5e-3;
  double last_learning_rate = 1e-5;  ///< the rate falls along a cosine, after a short rise
  double largest_gradient = 1;       ///< longer ones are shortened
  double weight_decay = 0;           ///< times the learning rate: the share by which weights shrink in each step
  LossKind loss = LossKind::robust;
  double energy_weight = 1;
  double stress_weight = 1;
  double tangent_weight = 0.1;
  double tangent_begin = 0.2;  ///< share of the epochs after which the tangent counts
  double error_floor = 0.005;  ///< of the robust loss
  OptimizerKind optimizer = OptimizerKind::soap;
  /// Not among the options that a checkpoint compares: a training may go on elsewhere, though not to the same bits.
  DeviceKind device = DeviceKind::automatic;
  double smallest_input_scale = 1;  ///< of strains at the first layer, when weights are drawn
  double largest_input_scale = 20;
  /// To begin with, of `shape` and the samples' bounds; none: drawn by the seed. Symmetries of its own are left out;
  /// `describe` gives a sum over its weights, so that a checkpoint knows it.
  std::optional<neural::Network> start;
  /// Of `shape.features` features; those of `start`, if there is one.
  neural::TileGeometry geometry;
  int stiffness_steps = 300;      ///< that first fit the stiffness branch to tangents at rest or next to it
  int stiffness_batch = 512;      ///< designs of one of these steps
  bool freeze_stiffness = false;  ///< the stiffness branch stays as it is then
  int patience = 0;               ///< epochs without a better validation after which training ends; 0: all are run
  int validation_interval = 5;
  std::int64_t seed = 1;
  /// Of the family. Each chunk is seen through a random one of them and the identity, as far as the image of its design
  /// lies in the box or not further from it than the data do, and is no design that is held out.
  std::vector<EnergySymmetry> symmetries;
};

/// Throws "training.invalid_option", which names the first option out of its range.
void check(const TrainingOptions& options, const Samples& samples);

/// By name, as they are kept with a model and compared when a checkpoint is taken up.
std::vector<std::pair<std::string, std::string>> describe(const TrainingOptions& options);

/// How well the stiffness branch fits: max over v of |v^T (L L^T - C*) v| / v^T C* v, the error along the worst
/// direction, of designs that it learns from and of some that it does not (negative where there are none).
struct StiffnessReport {
  int step = 0;
  std::int64_t designs = 0;  ///< with their images by symmetry
  double trained_mean = 0;
  double trained_median = 0;
  double unseen_mean = -1;
  double unseen_median = -1;
  double seconds = 0;
};

struct EpochReport {
  int epoch = 0;                    ///< from 1
  double loss = 0;                  ///< mean over the epoch's rows
  double validation_gradient = -1;  ///< mean relative error; negative where it was not measured
  double validation_energy = -1;
  double validation_stiffness = -1;  ///< median
  double learning_rate = 0;
  double seconds = 0;  ///< of training so far, over all runs
};

struct TrainingResult {
  neural::Network network;  ///< the best on the validation rows
  std::vector<EpochReport> history;
  std::optional<StiffnessReport> stiffness;  ///< of the branch's fit, where this call made it
  int best_epoch = 0;
  DeviceKind device = DeviceKind::cpu;  ///< that was used
  bool finished = false;                ///< false if it was interrupted: the same call goes on
};

/// Trains on the counted threads or on a GPU. First the stiffness branch is fitted, to `rest` or, where that is empty,
/// to the rows next to rest of the training's designs; a network to begin with keeps its own unless there is `rest`.
/// While it runs, `checkpoint` (if not empty) is rewritten every half minute and when it is interrupted; a call with
/// the same samples, split and options goes on from there and ends, on the processor, with the same bits as one that
/// was never interrupted. It is deleted at the end by the caller, once the model is written. A fit of the stiffness
/// branch that is interrupted begins anew.
///
/// Throws "training.invalid_option" (named), "training.diverged" (a loss that is not finite), "file.unreadable",
/// "file.write_failed", "training.no_device" (CUDA where there is none), and "training.different_options" for a
/// checkpoint of another training.
TrainingResult train(const Samples& samples, const Split& split, const TrainingOptions& options,
                     const std::filesystem::path& checkpoint, const CancellationToken& cancellation,
                     const std::function<void(const EpochReport&)>& report, const std::vector<RestStiffness>& rest = {},
                     const std::function<void(const StiffnessReport&)>& stiffness_report = {});

}  // namespace supple::training
