#include "supple/training/trainer.h"

#include <ATen/Parallel.h>
#include <fmt/format.h>
#include <torch/autograd.h>
#include <torch/cuda.h>
#include <torch/types.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>

#include "checkpoint.h"
#include "optimizer.h"
#include "supple/base/error.h"
#include "supple/base/random.h"
#include "supple/base/threads.h"
#include "supple/training/model_errors.h"
#include "torch_network.h"

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

/// The samples as tensors, a row each.
struct Data {
  Tensor p;  ///< designs, mapped to [-1, 1]
  Tensor strain;
  Tensor stress;
  Tensor energy;
  Tensor tangent;
};

Tensor rows_of(const Eigen::Ref<const Eigen::MatrixXd>& columns, torch::Device device) {
  auto tensor = torch::empty({columns.cols(), columns.rows()}, torch::kDouble);
  Eigen::Map<Eigen::MatrixXd>(tensor.data_ptr<double>(), columns.rows(), columns.cols()) = columns;
  return tensor.to(device, torch::kFloat).contiguous();
}

Data tensors_of(const Samples& samples, torch::Device device) {
  const auto n = static_cast<long>(samples.designs.size());
  const auto parameters = static_cast<long>(samples.lower.size());
  Eigen::MatrixXd p(parameters, n);
  for (long d = 0; d < n; ++d)
    for (long k = 0; k < parameters; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const double value = samples.designs[static_cast<std::size_t>(d)].parameters[i];
      p(k, d) = 2 * (value - samples.lower[i]) / (samples.upper[i] - samples.lower[i]) - 1;
    }
  return {rows_of(p, device), rows_of(samples.strain, device), rows_of(samples.stress, device),
          rows_of(samples.energy, device).squeeze(1), rows_of(samples.tangent, device)};
}

/// Rows of one design.
struct Chunk {
  int design = 0;
  std::vector<std::int64_t> rows;
};

template <class T>
void shuffle(std::vector<T>& items, RandomStream& stream) {
  for (std::size_t i = items.size(); i > 1; --i)
    std::swap(items[i - 1], items[static_cast<std::size_t>(stream.below(static_cast<int>(i)))]);
}

/// Training rows by design.
std::vector<Chunk> designs_of(const Samples& samples, const std::vector<int>& rows) {
  std::vector<Chunk> designs;
  int design = 0;
  for (const int row : rows) {
    while (row >= samples.designs[static_cast<std::size_t>(design)].first +
                      samples.designs[static_cast<std::size_t>(design)].count)
      ++design;
    if (designs.empty() || designs.back().design != design) designs.push_back({design, {}});
    designs.back().rows.push_back(row);
  }
  return designs;
}

std::vector<Chunk> chunks_of(const std::vector<Chunk>& designs, int chunk_rows, RandomStream& stream) {
  std::vector<Chunk> chunks;
  for (auto [design, rows] : designs) {
    shuffle(rows, stream);
    // Pieces of nearly equal length.
    const auto n = rows.size();
    const auto pieces = (n + static_cast<std::size_t>(chunk_rows) - 1) / static_cast<std::size_t>(chunk_rows);
    for (std::size_t i = 0; i < pieces; ++i)
      chunks.push_back(
          {design,
           {rows.begin() + static_cast<long>(i * n / pieces), rows.begin() + static_cast<long>((i + 1) * n / pieces)}});
  }
  shuffle(chunks, stream);
  return chunks;
}

/// A strain's map and what it does to stresses and tangents: e -> A e, S -> A^-T S, C -> A^-T C A^-1.
struct Symmetry {
  Eigen::Matrix3d strain = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d stress = Eigen::Matrix3d::Identity();
};

Tensor tensor_of(const Eigen::Matrix3d& matrix, const torch::TensorOptions& options) {
  auto tensor = torch::empty({3, 3}, torch::kDouble);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) tensor.data_ptr<double>()[3 * i + j] = matrix(i, j);
  return tensor.to(options);
}

/// 11, 12, 13, 22, 23, 33 as a full matrix.
Tensor full(const Tensor& six) {
  const auto column = [&](int i) { return six.select(1, i); };
  return torch::stack(
             {column(0), column(1), column(2), column(1), column(3), column(4), column(2), column(4), column(5)}, 1)
      .reshape({-1, 3, 3});
}

class Training {
 public:
  Training(const Samples& samples, const Split& split, const TrainingOptions& options)
      : samples_(samples),
        split_(split),
        options_(options),
        device_(torch::cuda::is_available() ? torch::kCUDA : torch::kCPU),
        data_(tensors_of(samples, device_)),
        designs_(designs_of(samples, split.training)) {
    const Eigen::Map<const Eigen::VectorXd> lower(samples.lower.data(), static_cast<long>(samples.lower.size()));
    const Eigen::Map<const Eigen::VectorXd> upper(samples.upper.data(), static_cast<long>(samples.upper.size()));
    network_ = draw_network(options.shape, lower, upper, {options.smallest_input_scale, options.largest_input_scale},
                            options.seed);
    if (options.shape.form == neural::EnergyForm::sum_of_squares) fit_stiffness();
    parameters_ = to_parameters(network_, torch::kFloat, device_);
    best_ = copies(parameters_);
    std::size_t trunk_end = 2 * static_cast<std::size_t>(options.shape.strain_layers + options.shape.parameter_layers +
                                                         options.shape.trunk_layers + 1);
    optimizer_.emplace(options.optimizer, parameters_, trunk_end);
    symmetries_.push_back({});
    for (const auto& map : options.symmetries) symmetries_.push_back({map, map.inverse().transpose()});
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

  bool patience_lost() const { return options_.patience > 0 && epochs_ - best_epoch_ >= options_.patience; }

  /// The branch begins with the tangents that the data hold next to rest.
  void fit_stiffness() {
    std::vector<double> targets;
    std::vector<std::int64_t> designs;
    for (const auto& design : designs_) {
      int nearest = -1;
      for (const auto row : design.rows)
        if (positive_definite(static_cast<int>(row)) &&
            (nearest < 0 || samples_.strain.col(row).norm() < samples_.strain.col(nearest).norm()))
          nearest = static_cast<int>(row);
      if (nearest < 0) continue;
      const auto l = Eigen::LLT<Eigen::Matrix3d>(tangent_of(nearest)).matrixL().toDenseMatrix();
      targets.insert(targets.end(), {std::log(l(0, 0)), std::log(l(1, 1)), std::log(l(2, 2)), l(1, 0) / l(0, 0),
                                     l(2, 0) / l(0, 0), l(2, 1) / l(1, 1)});
      designs.push_back(design.design);
    }
    if (designs.empty()) return;
    const auto target = torch::tensor(targets, torch::kDouble).reshape({-1, 6}).to(torch::kFloat);
    const auto p = data_.p.to(torch::kCPU).index_select(0, torch::tensor(designs));
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

  Eigen::Matrix3d tangent_of(int row) const {
    const auto c = samples_.tangent.col(row);
    Eigen::Matrix3d tangent;
    tangent << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
    return tangent;
  }
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
    const auto chunks = chunks_of(designs_, options_.chunk_rows, stream);
    double loss = 0;
    std::int64_t rows = 0;
    const bool with_tangents = options_.tangent_weight > 0 && epochs_ >= options_.tangent_begin * options_.epochs;
    for (std::size_t begin = 0; begin < chunks.size(); begin += static_cast<std::size_t>(options_.batch_chunks)) {
      if (cancellation.requested()) return false;
      const auto end = std::min(chunks.size(), begin + static_cast<std::size_t>(options_.batch_chunks));
      loss += step({chunks.begin() + static_cast<long>(begin), chunks.begin() + static_cast<long>(end)}, with_tangents,
                   stream);
      for (auto i = begin; i < end; ++i) rows += static_cast<std::int64_t>(chunks[i].rows.size());
    }
    ++epochs_;
    EpochReport report{epochs_, loss / static_cast<double>(rows), -1, -1, learning_rate(optimizer_->steps()), seconds_};
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
    if (const double error = report.validation_gradient + report.validation_energy;
        error < best_error_ * (1 - least_improvement)) {
      best_error_ = error;
      best_epoch_ = epochs_;
      best_ = copies(parameters_);
    }
  }

  /// One step of the optimizer; returns the sum of the rows' losses.
  double step(const std::vector<Chunk>& chunks, bool with_tangents, RandomStream& stream) {
    struct Shard {
      std::size_t begin = 0;
      std::size_t end = 0;
      std::vector<std::size_t> symmetry;  ///< of each chunk
      Tensor direction;
      std::vector<Tensor> gradients;
      double loss = 0;
    };
    std::array<Shard, shards> parts;
    double rows = 0;
    for (const auto& chunk : chunks) rows += static_cast<double>(chunk.rows.size());
    for (std::size_t s = 0; s < shards; ++s) {
      parts[s].begin = s * chunks.size() / shards;
      parts[s].end = (s + 1) * chunks.size() / shards;
      for (auto i = parts[s].begin; i < parts[s].end; ++i)
        parts[s].symmetry.push_back(static_cast<std::size_t>(stream.below(static_cast<int>(symmetries_.size()))));
      if (!with_tangents) continue;
      Eigen::Vector3d v(stream.normal(), stream.normal(), stream.normal());
      v.normalize();
      parts[s].direction = torch::tensor({v[0], v[1], v[2]}, torch::kDouble).to(data_.strain.options());
    }
    parallel_for(static_cast<int>(shards), [&](int s) {
      auto& part = parts[static_cast<std::size_t>(s)];
      if (part.begin == part.end) return;
      auto leaves = copies(parameters_);
      for (auto& leaf : leaves) leaf.set_requires_grad(true);
      const auto loss = loss_of(leaves, chunks, part.begin, part.end, part.symmetry, part.direction);
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

  Tensor loss_of(const Parameters& parameters, const std::vector<Chunk>& chunks, std::size_t begin, std::size_t end,
                 const std::vector<std::size_t>& symmetry, const Tensor& direction) const {
    std::vector<std::int64_t> rows;
    std::vector<std::int64_t> of;
    std::vector<std::int64_t> designs;
    std::vector<std::int64_t> seen_through;
    for (auto i = begin; i < end; ++i) {
      for (const auto row : chunks[i].rows) {
        rows.push_back(row);
        of.push_back(static_cast<std::int64_t>(i - begin));
        seen_through.push_back(static_cast<std::int64_t>(symmetry[i - begin]));
      }
      designs.push_back(chunks[i].design);
    }
    const auto index = torch::tensor(rows).to(device_);
    auto e = data_.strain.index_select(0, index);
    auto stress = data_.stress.index_select(0, index);
    auto tangent = full(data_.tangent.index_select(0, index));
    if (symmetries_.size() > 1) {
      std::vector<Tensor> strain_maps;
      std::vector<Tensor> stress_maps;
      for (const auto& map : symmetries_) {
        strain_maps.push_back(tensor_of(map.strain, e.options()));
        stress_maps.push_back(tensor_of(map.stress, e.options()));
      }
      const auto which = torch::tensor(seen_through).to(device_);
      const auto strain_map = torch::stack(strain_maps).index_select(0, which);
      const auto stress_map = torch::stack(stress_maps).index_select(0, which);
      e = (strain_map * e.unsqueeze(1)).sum(2);
      stress = (stress_map * stress.unsqueeze(1)).sum(2);
      tangent = (stress_map.unsqueeze(3) * tangent.unsqueeze(1)).sum(2);
      tangent = (tangent.unsqueeze(2) * stress_map.unsqueeze(1)).sum(3);
    }
    const Batch batch{data_.p.index_select(0, torch::tensor(designs).to(device_)), torch::tensor(of).to(device_), e};
    const auto answer = device_.is_cpu() ? response(options_.shape, parameters, batch, direction)
                                         : response_by_autograd(options_.shape, parameters, batch, direction);
    const auto energy = data_.energy.index_select(0, index);
    auto loss = options_.energy_weight * robust((answer.energy / energy - 1).square()) +
                options_.stress_weight * robust((answer.stress - stress).square().sum(1) / stress.square().sum(1));
    if (direction.defined()) {
      const auto along = (tangent * direction).sum(2).mul(direction).sum(1);
      // The mean of (v^T D v)^2 over unit vectors is of the order of a third of |D|^2 / 3.
      const auto relative = 3 * (answer.stiffness - along).square() / tangent.square().sum({1, 2});
      loss = loss + options_.tangent_weight * robust(relative);
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
  Data data_;
  std::vector<Chunk> designs_;
  std::int64_t chunks_per_epoch_ = 0;
  std::vector<Symmetry> symmetries_;
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

void check(const TrainingOptions& options, const Samples& samples) {
  const auto require = [](bool fine, const char* name, const std::string& range) {
    if (!fine) throw Error("training.invalid_option", fmt::format("{} must be {}.", name, range), {{name, range}});
  };
  require(options.shape.parameters == static_cast<int>(samples.lower.size()), "parameters", "the data set's number");
  require(options.shape.width >= 16 && options.shape.width % 16 == 0, "width", "a multiple of 16");
  require(options.epochs >= 1, "epochs", "at least 1");
  require(options.chunk_rows >= 1, "chunk_rows", "at least 1");
  require(options.batch_chunks >= 1, "batch_chunks", "at least 1");
  require(options.learning_rate > 0, "learning_rate", "positive");
  require(options.last_learning_rate >= 0 && options.last_learning_rate <= options.learning_rate, "last_learning_rate",
          "from 0 to learning_rate");
  require(options.largest_gradient > 0, "largest_gradient", "positive");
  require(options.energy_weight >= 0 && options.stress_weight >= 0 && options.energy_weight + options.stress_weight > 0,
          "energy_weight", "not negative, nor zero together with stress_weight");
  require(options.tangent_weight >= 0, "tangent_weight", "not negative");
  require(options.error_floor > 0, "error_floor", "positive");
  require(options.smallest_input_scale > 0 && options.largest_input_scale >= options.smallest_input_scale,
          "largest_input_scale", "at least smallest_input_scale, both positive");
  require(options.validation_interval >= 1, "validation_interval", "at least 1");
  require(options.patience >= 0, "patience", "not negative");
}

}  // namespace

std::string_view to_string(OptimizerKind kind) { return kind == OptimizerKind::soap ? "soap" : "adam"; }

OptimizerKind optimizer_of(std::string_view name) {
  for (const auto kind : {OptimizerKind::soap, OptimizerKind::adam})
    if (to_string(kind) == name) return kind;
  throw Error("training.invalid_option", fmt::format("There is no optimizer {}; the optimizers are soap, adam.", name));
}

std::vector<std::pair<std::string, std::string>> describe(const TrainingOptions& options) {
  std::vector<std::pair<std::string, std::string>> all;
  const auto add = [&](const char* name, const auto& value) { all.emplace_back(name, fmt::format("{}", value)); };
  const auto& shape = options.shape;
  add("form", to_string(shape.form));
  add("activation", to_string(shape.activation));
  add("width", shape.width);
  add("strain_layers", shape.strain_layers);
  add("parameter_layers", shape.parameter_layers);
  add("trunk_layers", shape.trunk_layers);
  add("residuals", shape.residuals);
  add("stiffness_width", shape.stiffness_width);
  add("epochs", options.epochs);
  add("chunk_rows", options.chunk_rows);
  add("batch_chunks", options.batch_chunks);
  add("learning_rate", options.learning_rate);
  add("last_learning_rate", options.last_learning_rate);
  add("largest_gradient", options.largest_gradient);
  add("energy_weight", options.energy_weight);
  add("stress_weight", options.stress_weight);
  add("tangent_weight", options.tangent_weight);
  add("tangent_begin", options.tangent_begin);
  add("error_floor", options.error_floor);
  add("optimizer", to_string(options.optimizer));
  add("smallest_input_scale", options.smallest_input_scale);
  add("largest_input_scale", options.largest_input_scale);
  add("stiffness_steps", options.stiffness_steps);
  add("patience", options.patience);
  add("validation_interval", options.validation_interval);
  add("symmetries", options.symmetries.size());
  add("seed", options.seed);
  return all;
}

TrainingResult train(const Samples& samples, const Split& split, const TrainingOptions& options,
                     const std::filesystem::path& checkpoint, const CancellationToken& cancellation,
                     const std::function<void(const EpochReport&)>& report) {
  check(options, samples);
  // LibTorch's own threads would compete with ours.
  at::set_num_threads(1);
  return Training(samples, split, options).run(checkpoint, cancellation, report);
}

}  // namespace supple::training
