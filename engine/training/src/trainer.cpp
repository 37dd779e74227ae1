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
#include "supple/base/error.h"
#include "supple/base/random.h"
#include "supple/base/threads.h"
#include "supple/neural/uniaxial_frame.h"
#include "supple/training/model_errors.h"
#include "torch_network.h"
#include "training_batches.h"

namespace supple::training {
namespace {

using torch::Tensor;

/// Parts of a batch that are worked on at once. A constant, so that results do not depend on the number of threads.
constexpr std::size_t shards = 2;
constexpr double warm_up_steps = 100;
constexpr double checkpoint_seconds = 30;
/// Share by which a validation must be better than the best to replace it.
constexpr double least_improvement = 1e-4;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

class Training {
 public:
  Training(const Samples& samples, const Split& split, const TrainingOptions& options)
      : samples_(samples),
        split_(split),
        options_(options),
        device_(torch::cuda::is_available() ? torch::kCUDA : torch::kCPU),
        data_(samples, options.symmetries, held_out(samples, split), device_),
        designs_(chunks_by_design(samples, split.training)) {
    const Eigen::Map<const Eigen::VectorXd> lower(samples.lower.data(), static_cast<long>(samples.lower.size()));
    const Eigen::Map<const Eigen::VectorXd> upper(samples.upper.data(), static_cast<long>(samples.upper.size()));
    if (options.start) {
      network_ = *options.start;
      network_.symmetries.clear();
    } else {
      network_ = draw_network(options.shape, lower, upper, {options.smallest_input_scale, options.largest_input_scale},
                              options.seed);
      if (options.shape.form == neural::EnergyForm::sum_of_squares) fit_stiffness();
    }
    parameters_ = to_parameters(network_, torch::kFloat, device_);
    best_ = copies(parameters_);
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
                     const std::function<void(const EpochReport&)>& report) {
    if (!file.empty() && std::filesystem::exists(file)) restore(read_checkpoint(file), file);
    double begin = now();
    double saved = begin;
    while (epochs_ < options_.epochs && !patience_lost()) {
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

 private:
  static Parameters copies(const Parameters& parameters) {
    Parameters made;
    for (const auto& tensor : parameters) made.push_back(tensor.detach().clone());
    return made;
  }

  /// Designs that choosing and judging know.
  static std::vector<int> held_out(const Samples& samples, const Split& split) {
    std::vector<int> designs;
    for (const auto* rows : {&split.validation, &split.test})
      for (const auto& chunk : chunks_by_design(samples, *rows)) designs.push_back(chunk.design);
    return designs;
  }

  bool patience_lost() const { return options_.patience > 0 && epochs_ - best_epoch_ >= options_.patience; }

  /// The branch begins with the tangents that the data hold next to rest.
  void fit_stiffness() {
    std::vector<double> targets;
    std::vector<SeenDesign> designs;
    for (const auto& design : designs_) {
      int nearest = -1;
      for (const auto row : design.rows)
        if (positive_definite(static_cast<int>(row)) &&
            (nearest < 0 || samples_.strain.col(row).norm() < samples_.strain.col(nearest).norm()))
          nearest = static_cast<int>(row);
      if (nearest < 0) continue;
      for (const int symmetry : data_.symmetries_of(design.design)) {
        const auto& map = data_.stress_map(symmetry);
        const Eigen::Matrix3d tangent = map * tangent_of(nearest) * map.transpose();
        const auto l = Eigen::LLT<Eigen::Matrix3d>(tangent).matrixL().toDenseMatrix();
        targets.insert(targets.end(), {std::log(l(0, 0)), std::log(l(1, 1)), std::log(l(2, 2)), l(1, 0) / l(0, 0),
                                       l(2, 0) / l(0, 0), l(2, 1) / l(1, 1)});
        designs.push_back({design.design, symmetry});
      }
    }
    if (designs.empty()) return;
    const auto target = torch::tensor(targets, torch::kDouble).reshape({-1, 6}).to(torch::kFloat);
    const auto p = data_.parameters(designs).to(torch::kCPU);
    auto parameters = to_parameters(network_, torch::kFloat, torch::kCPU);
    // The mean goes to the last bias: what is left to learn is of order one.
    parameters.back().copy_(target.mean(0));
    Optimizer optimizer(OptimizerKind::adam, parameters, 0);
    for (int step = 0; step < options_.stiffness_steps; ++step) {
      auto leaves = copies(parameters);
      for (auto& leaf : leaves) leaf.set_requires_grad(true);
      const auto error = stiffness_outputs(options_.shape, leaves, p) - target;
      (error.square() + 0.01).sqrt().mean().backward();
      const double rate = 3e-3 * 0.5 * (1 + std::cos(M_PI * step / options_.stiffness_steps));
      optimizer.step(gradients(leaves), rate);
    }
    assign(network_, parameters);
  }

  static std::vector<Tensor> gradients(const Parameters& leaves) {
    std::vector<Tensor> made;
    for (const auto& leaf : leaves) made.push_back(leaf.grad().defined() ? leaf.grad() : torch::zeros_like(leaf));
    return made;
  }

  Eigen::Matrix3d tangent_of(int row) const { return neural::symmetric_matrix(samples_.tangent.col(row)); }
  bool positive_definite(int row) const {
    return Eigen::LLT<Eigen::Matrix3d>(tangent_of(row)).info() == Eigen::Success;
  }

  double learning_rate(std::int64_t step) const {
    const double share = static_cast<double>(step) / static_cast<double>(steps_per_epoch() * options_.epochs);
    const double fall = 0.5 * (1 + std::cos(M_PI * std::min(share, 1.0)));
    const double rate = options_.last_learning_rate + (options_.learning_rate - options_.last_learning_rate) * fall;
    return rate * std::min(1.0, static_cast<double>(step) / warm_up_steps);
  }

  /// False if it was interrupted; then nothing of the epoch counts.
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
      best_ = copies(parameters_);
      best_epoch_ = epochs_;
      return;
    }
    const auto errors = row_errors(network_, samples_, split_.validation);
    report.validation_gradient = errors.gradient.mean();
    report.validation_energy = errors.energy.mean();
    report.validation_stiffness = statistics(errors.stiffness).median;
    if (const double error = report.validation_gradient + report.validation_energy;
        error < best_error_ * (1 - least_improvement)) {
      best_error_ = error;
      best_epoch_ = epochs_;
      best_ = copies(parameters_);
    }
  }

  /// One step of the optimizer; returns the sum of the rows' losses.
  double step(std::span<const Chunk> chunks, bool with_tangents, RandomStream& stream) {
    struct Shard {
      std::span<const Chunk> chunks;
      std::vector<int> symmetry;  ///< of each chunk
      Tensor directions;          ///< unit vectors, rows x 3; undefined without tangents
      std::vector<Tensor> gradients;
      double loss = 0;
    };
    std::array<Shard, shards> parts;
    double rows = 0;
    for (const auto& chunk : chunks) rows += static_cast<double>(chunk.rows.size());
    for (std::size_t s = 0; s < shards; ++s) {
      const auto begin = s * chunks.size() / shards;
      parts[s].chunks = chunks.subspan(begin, (s + 1) * chunks.size() / shards - begin);
      for (const auto& chunk : parts[s].chunks) {
        const auto& symmetries = data_.symmetries_of(chunk.design);
        parts[s].symmetry.push_back(
            symmetries[static_cast<std::size_t>(stream.below(static_cast<int>(symmetries.size())))]);
      }
      if (!with_tangents || parts[s].chunks.empty()) continue;
      parts[s].directions = unit_vectors(stream, parts[s].chunks).to(data_.tensor_options());
    }
    parallel_for(static_cast<int>(shards), [&](int s) {
      auto& part = parts[static_cast<std::size_t>(s)];
      if (part.chunks.empty()) return;
      auto leaves = copies(parameters_);
      for (auto& leaf : leaves) leaf.set_requires_grad(true);
      const auto loss = loss_of(leaves, part.chunks, part.symmetry, part.directions);
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
    double square = 0;
    for (const auto& gradient : sum) square += gradient.square().sum().item<double>();
    if (!std::isfinite(square))
      throw Error("training.diverged",
                  fmt::format("The loss of epoch {} is not finite; a smaller learning rate may help.", epochs_ + 1));
    if (const double norm = std::sqrt(square); norm > options_.largest_gradient)
      for (auto& gradient : sum) gradient *= options_.largest_gradient / norm;
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

  /// Sum of the losses of the chunks' rows; of tangents only where there are directions.
  Tensor loss_of(const Parameters& parameters, std::span<const Chunk> chunks, std::span<const int> symmetry,
                 const Tensor& unit_vectors) const {
    const auto [batch, energy, stress, tangent, whitening] = data_.labelled(chunks, symmetry);
    Tensor directions;
    if (unit_vectors.defined()) directions = (whitening * unit_vectors.unsqueeze(1)).sum(2);
    const auto answer = device_.is_cpu() ? response(options_.shape, parameters, batch, directions)
                                         : response_by_autograd(options_.shape, parameters, batch, directions);
    auto loss = options_.energy_weight * robust((answer.energy / energy - 1).square()) +
                options_.stress_weight * robust((answer.stress - stress).square().sum(1) / stress.square().sum(1));
    if (directions.defined()) {
      const auto along = (tangent * directions.unsqueeze(1)).sum(2).mul(directions).sum(1);
      loss = loss + options_.tangent_weight * robust((answer.stiffness - along).square());
    }
    return loss.sum();
  }

  Tensor robust(const Tensor& squared_error) const {
    return torch::log1p((squared_error + options_.error_floor * options_.error_floor).sqrt());
  }

  /// What must agree for a checkpoint to be taken up: the options and the rows.
  std::vector<std::pair<std::string, std::string>> identity() const {
    auto all = describe(options_);
    const auto number = [](double value) { return fmt::format("{}", value); };
    double sum = 0;
    for (const int row : split_.training) sum += samples_.energy[row] * (1 + row % 7);
    all.emplace_back("training_rows", std::to_string(split_.training.size()));
    all.emplace_back("training_energies", number(sum));
    return all;
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
    const auto mine = identity();
    for (std::size_t i = 0; i < mine.size(); ++i)
      if (i >= from.options.size() || from.options[i] != mine[i])
        throw Error("training.different_options",
                    fmt::format("{} was begun with {} = {}, not {}.", file.string(), mine[i].first,
                                i < from.options.size() ? from.options[i].second : "nothing", mine[i].second),
                    {{mine[i].first, "as in the checkpoint, or another file"}});
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
    return {network_, history_, best_epoch_, finished};
  }

  const Samples& samples_;
  const Split& split_;
  TrainingOptions options_;
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
};

}  // namespace

TrainingResult train(const Samples& samples, const Split& split, const TrainingOptions& options,
                     const std::filesystem::path& checkpoint, const CancellationToken& cancellation,
                     const std::function<void(const EpochReport&)>& report) {
  check(options, samples);
  // LibTorch's own threads would compete with ours.
  at::set_num_threads(1);
  return Training(samples, split, options).run(checkpoint, cancellation, report);
}

}  // namespace supple::training
