#include "supple/training/trainer.h"

#include <ATen/Parallel.h>
#include <fmt/format.h>
#include <torch/autograd.h>
#include <torch/cuda.h>
#include <torch/types.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "checkpoint.h"
#include "optimizer.h"
#include "row_losses.h"
#include "stiffness_fit.h"
#include "supple/base/error.h"
#include "supple/base/random.h"
#include "supple/base/threads.h"
#include "supple/neural/uniaxial_frame.h"
#include "supple/training/model_errors.h"
#include "torch_network.h"
#include "training_batches.h"
#include "training_set.h"

namespace supple::training {
namespace {

using torch::Tensor;

/// Parts into which each batch is divided, to compute them in parallel. It is a constant, so that results do not depend
/// on the number of threads.
constexpr std::size_t shard_count = 2;
constexpr double warm_up_steps = 100;
constexpr double checkpoint_seconds = 30;
/// Fraction by which the validation error must fall below the least one before an epoch counts as the best.
constexpr double min_improvement = 1e-4;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

class Training {
 public:
  Training(const Samples& samples, const Split& split, const TrainingOptions& options,
           const std::vector<RestStiffness>& rest)
      : samples_(samples),
        split_(split),
        options_(options),
        rest_(rest),
        device_kind_(usable_device(options.device)),
        device_(device_kind_ == DeviceKind::cuda ? torch::kCUDA : torch::kCPU),
        data_(samples, options.symmetries, held_out(samples, split), options.geometry, device_),
        designs_(chunks_by_design(samples, split.training)) {
    const Eigen::Map<const Eigen::VectorXd> lower(samples.lower.data(), static_cast<long>(samples.lower.size()));
    const Eigen::Map<const Eigen::VectorXd> upper(samples.upper.data(), static_cast<long>(samples.upper.size()));
    if (options.start) {
      network_ = neural::without_mesh_correction(*options.start);
      network_.symmetries.clear();
    } else {
      network_ =
          draw_network(options.shape, lower, upper, {options.min_input_scale, options.max_input_scale}, options.seed);
      network_.geometry = options.geometry;
    }
    parameters_ = to_parameters(network_, torch::kFloat, device_);
    best_ = clones(parameters_);
    std::size_t trunk_end = 2 * static_cast<std::size_t>(options.shape.strain_layers + options.shape.parameter_layers +
                                                         options.shape.trunk_layers + 1);
    optimizer_.emplace(options.optimizer, parameters_, trunk_end, options.weight_decay);
    for (const auto& chunk : designs_) {
      const auto rows = static_cast<int>(chunk.rows.size());
      chunks_per_epoch_ += (rows + options.chunk_rows - 1) / options.chunk_rows;
    }
  }

  std::int64_t steps_per_epoch() const {
    return (chunks_per_epoch_ + options_.batch_chunks - 1) / options_.batch_chunks;
  }

  TrainingResult run(const std::filesystem::path& file, const CancellationToken& cancellation,
                     const std::function<void(const EpochReport&)>& report,
                     const std::function<void(const StiffnessReport&)>& stiffness_report) {
    if (!file.empty() && std::filesystem::exists(file)) {
      restore(read_checkpoint(file), file);
    } else {
      const double begin = now();
      if (!fit_stiffness(cancellation, stiffness_report)) return result(false);
      best_ = clones(parameters_);
      seconds_ = now() - begin;
      // The fit may take as long as many epochs, and is saved before the first one.
      if (!file.empty() && seconds_ > checkpoint_seconds) write_checkpoint(file, checkpoint());
    }
    double begin = now();
    double saved = begin;
    while (epochs_ < options_.epochs && !patience_exhausted()) {
      const auto interrupted = !run_epoch(cancellation);
      const double time = now();
      seconds_ += time - begin;
      begin = time;
      if (interrupted) return result(false);
      report(history_.back());
      if (!file.empty() && (time - saved > checkpoint_seconds || cancellation.requested())) {
        write_checkpoint(file, checkpoint());
        saved = now();
      }
      if (cancellation.requested() && epochs_ < options_.epochs) return result(false);
    }
    return result(true);
  }

  /// The network with which training begins. Empty if the fit of the stiffness branch was cancelled.
  std::optional<neural::Network> initial_network(const CancellationToken& cancellation,
                                                 const std::function<void(const StiffnessReport&)>& report) {
    if (!fit_stiffness(cancellation, report)) return std::nullopt;
    assign(network_, parameters_);
    return network_;
  }

 private:
  static Parameters clones(const Parameters& parameters) {
    Parameters tensors;
    for (const auto& tensor : parameters) tensors.push_back(tensor.detach().clone());
    return tensors;
  }

  /// Designs of the validation and the test.
  static std::vector<int> held_out(const Samples& samples, const Split& split) {
    std::vector<int> designs;
    for (const auto* rows : {&split.validation, &split.test})
      for (const auto& chunk : chunks_by_design(samples, *rows)) designs.push_back(chunk.design);
    return designs;
  }

  bool patience_exhausted() const { return options_.patience > 0 && epochs_ - best_epoch_ >= options_.patience; }

  /// Fits the stiffness branch unless it has to stay as it is. Returns false if it was cancelled.
  bool fit_stiffness(const CancellationToken& cancellation, const std::function<void(const StiffnessReport&)>& report) {
    if (options_.shape.form == neural::EnergyForm::softplus || options_.stiffness_steps == 0) return true;
    if (options_.start && rest_.empty()) return true;
    const auto targets =
        stiffness_targets(samples_, rest_.empty() ? tangents_near_rest() : rest_, held_out(samples_, split_), options_);
    if (targets.designs() == 0) return true;
    const auto stiffness_offset = static_cast<std::ptrdiff_t>(stiffness_begin(options_.shape));
    Parameters branch(parameters_.begin() + stiffness_offset, parameters_.end());
    stiffness_ = training::fit_stiffness(branch, targets, options_, !options_.start, cancellation, report);
    return stiffness_.has_value();
  }

  /// The tangent of each training design at its smallest strain where the tangent is positive definite.
  std::vector<RestStiffness> tangents_near_rest() const {
    std::vector<RestStiffness> rest;
    for (const auto& design : designs_) {
      int nearest = -1;
      for (const auto row : design.rows)
        if (positive_definite(static_cast<int>(row)) &&
            (nearest < 0 || samples_.strain.col(row).norm() < samples_.strain.col(nearest).norm()))
          nearest = static_cast<int>(row);
      if (nearest >= 0)
        rest.push_back({samples_.designs[static_cast<std::size_t>(design.design)].parameters, tangent_of(nearest)});
    }
    return rest;
  }

  static std::vector<Tensor> gradients(const Parameters& leaves) {
    std::vector<Tensor> tensors;
    for (const auto& leaf : leaves) tensors.push_back(leaf.grad().defined() ? leaf.grad() : torch::zeros_like(leaf));
    return tensors;
  }

  Eigen::Matrix3d tangent_of(int row) const { return neural::symmetric_matrix(samples_.tangent.col(row)); }
  bool positive_definite(int row) const {
    return Eigen::LLT<Eigen::Matrix3d>(tangent_of(row)).info() == Eigen::Success;
  }

  double learning_rate(std::int64_t step) const {
    const double fraction = static_cast<double>(step) / static_cast<double>(steps_per_epoch() * options_.epochs);
    const double cosine_factor = 0.5 * (1 + std::cos(M_PI * std::min(fraction, 1.0)));
    const double rate =
        options_.final_learning_rate + (options_.learning_rate - options_.final_learning_rate) * cosine_factor;
    return rate * std::min(1.0, static_cast<double>(step) / warm_up_steps);
  }

  /// Trains for one epoch. Returns false if it was interrupted; the parameters then contain a part of an epoch and must
  /// not be saved.
  bool run_epoch(const CancellationToken& cancellation) {
    RandomStream stream(fmt::format("epoch {}", epochs_ + 1), static_cast<std::uint64_t>(options_.seed));
    const auto chunks = shuffled_chunks(designs_, options_.chunk_rows, stream);
    double loss = 0;
    std::int64_t rows = 0;
    const bool with_tangents = options_.tangent_weight > 0 && epochs_ >= options_.tangent_begin * options_.epochs;
    const auto batch_chunks = static_cast<std::size_t>(options_.batch_chunks);
    for (std::size_t begin = 0; begin < chunks.size(); begin += batch_chunks) {
      if (cancellation.requested()) return false;
      const auto batch = std::span(chunks).subspan(begin, std::min(batch_chunks, chunks.size() - begin));
      loss += step(batch, with_tangents, stream);
      for (const auto& chunk : batch) rows += static_cast<std::int64_t>(chunk.rows.size());
    }
    ++epochs_;
    EpochReport report{.epoch = epochs_,
                       .loss = loss / static_cast<double>(rows),
                       .learning_rate = learning_rate(optimizer_->steps()),
                       .seconds = seconds_};
    if (epochs_ % options_.validation_interval == 0 || epochs_ == options_.epochs) validate(report);
    history_.push_back(report);
    return true;
  }

  void validate(EpochReport& report) {
    assign(network_, parameters_);
    if (split_.validation.empty()) {
      best_ = clones(parameters_);
      best_epoch_ = epochs_;
      return;
    }
    const auto errors = row_errors(network_, samples_, split_.validation);
    report.validation_gradient = errors.gradient.mean();
    report.validation_energy = errors.energy.mean();
    report.validation_stiffness = statistics(errors.stiffness).median;
    if (const double error = report.validation_gradient + report.validation_energy;
        error < best_error_ * (1 - min_improvement)) {
      best_error_ = error;
      best_epoch_ = epochs_;
      best_ = clones(parameters_);
    }
  }

  /// Makes one step of the optimizer. Returns the sum of the losses of the rows.
  double step(std::span<const Chunk> chunks, bool with_tangents, RandomStream& stream) {
    struct Shard {
      std::span<const Chunk> chunks;
      std::vector<int> symmetry;  ///< number of the symmetry that is applied to each chunk
      Tensor directions;          ///< unit vectors, rows x 3; undefined without tangents
      std::vector<Tensor> gradients;
      double loss = 0;
    };
    std::array<Shard, shard_count> parts;
    double rows = 0;
    for (const auto& chunk : chunks) rows += static_cast<double>(chunk.rows.size());
    for (std::size_t s = 0; s < shard_count; ++s) {
      const auto begin = s * chunks.size() / shard_count;
      parts[s].chunks = chunks.subspan(begin, (s + 1) * chunks.size() / shard_count - begin);
      for (const auto& chunk : parts[s].chunks) {
        const auto& symmetries = data_.symmetries_of(chunk.design);
        parts[s].symmetry.push_back(
            symmetries[static_cast<std::size_t>(stream.below(static_cast<int>(symmetries.size())))]);
      }
      if (!with_tangents || parts[s].chunks.empty()) continue;
      parts[s].directions = unit_vectors(stream, parts[s].chunks).to(data_.tensor_options());
    }
    parallel_for(static_cast<int>(shard_count), [&](int s) {
      auto& part = parts[static_cast<std::size_t>(s)];
      if (part.chunks.empty()) return;
      auto leaves = clones(parameters_);
      // Frozen parameters have no gradient. The optimizer gets zeros for them, and its steps are then zero.
      const auto trainable_count = options_.freeze_stiffness ? stiffness_begin(options_.shape) : leaves.size();
      for (std::size_t i = 0; i < trainable_count; ++i) leaves[i].set_requires_grad(true);
      const auto loss = loss_of_chunks(leaves, part.chunks, part.symmetry, part.directions);
      (loss / rows).backward();
      part.gradients = gradients(leaves);
      part.loss = loss.item<double>();
    });
    std::vector<Tensor> sum;
    double loss = 0;
    for (auto& part : parts) {
      loss += part.loss;
      if (part.gradients.empty()) continue;
      if (sum.empty())
        sum = std::move(part.gradients);
      else
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += part.gradients[i];
    }
    // All norms are transferred from a GPU at once.
    std::vector<Tensor> squares;
    squares.reserve(sum.size());
    for (const auto& gradient : sum) squares.push_back(gradient.square().sum());
    const auto squared_norms = torch::stack(squares).to(torch::kCPU, torch::kDouble);
    double squared_norm = 0;
    for (std::int64_t i = 0; i < squared_norms.size(0); ++i) squared_norm += squared_norms.data_ptr<double>()[i];
    if (!std::isfinite(squared_norm))
      throw Error("training.diverged",
                  fmt::format("The loss of epoch {} is not finite; a smaller learning rate may help.", epochs_ + 1));
    if (const double norm = std::sqrt(squared_norm); norm > options_.max_gradient_norm)
      for (auto& gradient : sum) gradient *= options_.max_gradient_norm / norm;
    optimizer_->step(sum, learning_rate(optimizer_->steps() + 1));
    return loss;
  }

  static Tensor unit_vectors(RandomStream& stream, std::span<const Chunk> chunks) {
    std::vector<double> numbers;
    for (const auto& chunk : chunks)
      for (std::size_t i = 0; i < chunk.rows.size(); ++i) {
        const Eigen::Vector3d v = Eigen::Vector3d(stream.normal(), stream.normal(), stream.normal()).normalized();
        numbers.insert(numbers.end(), v.begin(), v.end());
      }
    return torch::tensor(numbers, torch::kDouble).reshape({-1, 3});
  }

  /// Sum of the losses of the chunks' rows. Tangents are included if `unit_vectors` is defined.
  Tensor loss_of_chunks(const Parameters& parameters, std::span<const Chunk> chunks, std::span<const int> symmetry,
                        const Tensor& unit_vectors) const {
    const auto rows = data_.labelled(chunks, symmetry);
    Tensor directions;
    if (unit_vectors.defined()) directions = (rows.whitening * unit_vectors.unsqueeze(1)).sum(2);
    return row_losses(options_, response(options_.shape, parameters, rows.batch, directions), rows, directions).sum();
  }

  /// The identity of this training, which must be that of a checkpoint from which it continues.
  std::vector<std::pair<std::string, std::string>> identity() const {
    return training::identity(samples_, split_, options_, rest_);
  }

  Checkpoint checkpoint() const {
    const auto named = [](const Parameters& parameters) {
      Checkpoint::Tensors tensors;
      for (std::size_t i = 0; i < parameters.size(); ++i) tensors.emplace_back(std::to_string(i), parameters[i]);
      return tensors;
    };
    return {
        identity(),  named(parameters_), named(best_), optimizer_->state(), optimizer_->steps(), epochs_, best_epoch_,
        best_error_, seconds_,           history_};
  }

  void restore(const Checkpoint& from, const std::filesystem::path& file) {
    require_same(identity(), from.options, file);
    const auto copy = [&](const Checkpoint::Tensors& tensors, Parameters& to) {
      if (tensors.size() != to.size())
        throw Error("file.unreadable", file.string() + ": its network has another shape.");
      const torch::NoGradGuard no_graph;
      for (std::size_t i = 0; i < to.size(); ++i) {
        if (tensors[i].second.sizes() != to[i].sizes())
          throw Error("file.unreadable", file.string() + ": its network has another shape.");
        to[i].copy_(tensors[i].second);
      }
    };
    copy(from.parameters, parameters_);
    copy(from.best, best_);
    optimizer_->restore(from.optimizer, from.steps);
    epochs_ = from.epochs;
    best_epoch_ = from.best_epoch;
    best_error_ = from.best_error;
    seconds_ = from.seconds;
    history_ = from.history;
  }

  TrainingResult result(bool finished) {
    assign(network_, best_);
    return {network_, history_, stiffness_, best_epoch_, device_kind_, finished};
  }

  const Samples& samples_;
  const Split& split_;
  TrainingOptions options_;
  const std::vector<RestStiffness>& rest_;
  DeviceKind device_kind_;
  torch::Device device_;
  TrainingData data_;
  std::vector<Chunk> designs_;
  std::int64_t chunks_per_epoch_ = 0;
  neural::Network network_;
  Parameters parameters_;
  Parameters best_;
  std::optional<Optimizer> optimizer_;
  int epochs_ = 0;
  int best_epoch_ = 0;
  double best_error_ = std::numeric_limits<double>::infinity();
  double seconds_ = 0;
  std::vector<EpochReport> history_;
  std::optional<StiffnessReport> stiffness_;
};

}  // namespace

DeviceKind usable_device(DeviceKind wanted) {
  const bool found = wanted != DeviceKind::cpu && torch::cuda::is_available();
  if (wanted == DeviceKind::cuda && !found)
    throw Error("training.no_device", "LibTorch finds no CUDA device, or is built without CUDA.",
                {{"device", "automatic or cpu on this machine"}});
  return found ? DeviceKind::cuda : DeviceKind::cpu;
}

TrainingResult train(const Samples& samples, const Split& split, const TrainingOptions& options,
                     const std::filesystem::path& checkpoint, const CancellationToken& cancellation,
                     const std::function<void(const EpochReport&)>& report, const std::vector<RestStiffness>& rest,
                     const std::function<void(const StiffnessReport&)>& stiffness_report) {
  check(options, samples);
  // Threads of LibTorch would compete with those of parallel_for.
  at::set_num_threads(1);
  return Training(samples, split, options, rest).run(checkpoint, cancellation, report, stiffness_report);
}

bool export_training(const std::filesystem::path& path, const Samples& samples, const Split& split,
                     const TrainingOptions& options, const std::vector<RestStiffness>& rest,
                     const CancellationToken& cancellation,
                     const std::function<void(const StiffnessReport&)>& stiffness_report) {
  check(options, samples);
  at::set_num_threads(1);
  const auto initial_network = Training(samples, split, options, rest).initial_network(cancellation, stiffness_report);
  if (initial_network) write_training_set(path, samples, split, options, rest, *initial_network);
  return initial_network.has_value();
}

}  // namespace supple::training
