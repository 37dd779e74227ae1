#include "optimizer.h"

#include <torch/types.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "matrix_product.h"
#include "supple/base/error.h"
#include "supple/base/threads.h"

namespace supple::training {
namespace {

using torch::Tensor;

constexpr double first_decay = 0.95;
constexpr double second_decay = 0.99;
constexpr double smallest_deviation = 1e-8;
/// Steps between renewals of the bases, and between updates of the statistics that they come from.
constexpr std::int64_t basis_interval = 50;
constexpr std::int64_t statistics_interval = 4;
constexpr double statistics_decay = 0.96;
/// Columns of one part of a matrix, at most.
constexpr std::int64_t most_columns = 256;

/// Eigenvectors of a symmetric matrix as columns.
Tensor eigenvectors(const Tensor& symmetric) {
  const auto n = symmetric.size(0);
  const auto exact = symmetric.to(torch::kCPU, torch::kDouble).contiguous();
  const Eigen::Map<const Eigen::MatrixXd> matrix(exact.data_ptr<double>(), n, n);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  auto vectors = torch::empty({n, n}, torch::kDouble);
  // Eigen's columns are LibTorch's rows.
  Eigen::Map<Eigen::MatrixXd>(vectors.data_ptr<double>(), n, n) = solver.eigenvectors();
  return vectors.t().contiguous().to(symmetric.options());
}

/// Takes g into Adam's two moments, which `first_share` and `second_share` correct for their beginning, and returns its
/// direction.
Tensor direction_of(Tensor& first, Tensor& second, const Tensor& g, double first_share, double second_share) {
  if (!for_our_kernels(g)) {
    first.mul_(first_decay).add_(g, 1 - first_decay);
    second.mul_(second_decay).addcmul_(g, g, 1 - second_decay);
    return first / first_share / (second / second_share).sqrt_().add_(smallest_deviation);
  }
  // One pass instead of nine.
  auto direction = torch::empty_like(first);
  const auto whole = g.contiguous();
  const float* from = whole.data_ptr<float>();
  float* m = first.data_ptr<float>();
  float* v = second.data_ptr<float>();
  float* to = direction.data_ptr<float>();
  const auto mean = static_cast<float>(1 / first_share);
  const auto variance = static_cast<float>(1 / second_share);
  constexpr auto keep = static_cast<float>(first_decay);
  constexpr auto keep_square = static_cast<float>(second_decay);
  for (std::int64_t i = 0; i < first.numel(); ++i) {
    m[i] = keep * m[i] + (1 - keep) * from[i];
    v[i] = keep_square * v[i] + (1 - keep_square) * from[i] * from[i];
    to[i] = mean * m[i] / (std::sqrt(variance * v[i]) + static_cast<float>(smallest_deviation));
  }
  return direction;
}

}  // namespace

Optimizer::Optimizer(OptimizerKind kind, Parameters& parameters, std::size_t preconditioned, double weight_decay)
    : kind_(kind), parameters_(parameters), weight_decay_(weight_decay) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const bool inner_matrix = i < preconditioned && parameters[i].dim() == 2;
    const auto columns = parameters[i].dim() == 2 ? parameters[i].size(1) : 0;
    for (std::int64_t begin = 0; begin < std::max<std::int64_t>(columns, 1); begin += most_columns) {
      Block block;
      block.parameter = i;
      block.column = begin;
      block.columns = std::min(columns - begin, most_columns);
      block.has_bases = inner_matrix && kind == OptimizerKind::soap;
      block.decays = inner_matrix && weight_decay > 0;
      const auto of = part(block, parameters[i]).detach();
      block.first = torch::zeros_like(of, torch::MemoryFormat::Contiguous);
      block.second = torch::zeros_like(of, torch::MemoryFormat::Contiguous);
      if (block.has_bases) {
        block.left_statistics = torch::zeros({of.size(0), of.size(0)}, of.options());
        block.right_statistics = torch::zeros({of.size(1), of.size(1)}, of.options());
      }
      blocks_.push_back(std::move(block));
    }
  }
}

Tensor Optimizer::part(const Block& block, const Tensor& whole) {
  return whole.dim() == 2 ? whole.narrow(1, block.column, block.columns) : whole;
}

void Optimizer::step(const std::vector<Tensor>& gradients, double learning_rate) {
  ++steps_;
  parallel_for(static_cast<int>(blocks_.size()), [&](int i) {
    const torch::NoGradGuard no_graph;
    auto& block = blocks_[static_cast<std::size_t>(i)];
    step(block, part(block, gradients[block.parameter]), learning_rate);
  });
}

void Optimizer::step(Block& block, const Tensor& gradient, double learning_rate) const {
  Tensor g = gradient;
  if (block.has_bases) {
    if (steps_ % statistics_interval == 1) {
      block.left_statistics.mul_(statistics_decay).add_(product(g, false, g, true), 1 - statistics_decay);
      block.right_statistics.mul_(statistics_decay).add_(product(g, true, g, false), 1 - statistics_decay);
    }
    if (steps_ == 1 || steps_ % basis_interval == 0) renew_bases(block);
    g = product(product(block.left_basis, true, g, false), false, block.right_basis, false);
  }
  const auto t = static_cast<double>(steps_);
  Tensor change =
      direction_of(block.first, block.second, g, 1 - std::pow(first_decay, t), 1 - std::pow(second_decay, t));
  if (block.has_bases)
    change = product(product(block.left_basis, false, change, false), false, block.right_basis, true);
  auto values = part(block, parameters_[block.parameter]);
  if (block.decays) values.mul_(1 - learning_rate * weight_decay_);
  values.add_(change, -learning_rate);
}

void Optimizer::renew_bases(Block& block) const {
  const auto left = eigenvectors(block.left_statistics);
  const auto right = eigenvectors(block.right_statistics);
  if (block.left_basis.defined()) {
    const auto change_left = product(left, true, block.left_basis, false);
    const auto change_right = product(block.right_basis, true, right, false);
    block.first = product(product(change_left, false, block.first, false), false, change_right, false).contiguous();
    block.second =
        product(product(change_left.square(), false, block.second, false), false, change_right.square(), false)
            .contiguous();
  }
  block.left_basis = left;
  block.right_basis = right;
}

std::vector<std::pair<std::string, Tensor>> Optimizer::state() const {
  std::vector<std::pair<std::string, Tensor>> tensors;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const auto& block = blocks_[i];
    const auto add = [&](const char* name, const Tensor& tensor) {
      if (tensor.defined()) tensors.emplace_back(std::to_string(i) + "/" + name, tensor);
    };
    add("first", block.first);
    add("second", block.second);
    add("left_statistics", block.left_statistics);
    add("right_statistics", block.right_statistics);
    add("left_basis", block.left_basis);
    add("right_basis", block.right_basis);
  }
  return tensors;
}

void Optimizer::restore(const std::vector<std::pair<std::string, Tensor>>& state, std::int64_t steps) {
  const auto find = [&](const std::string& name, const Tensor& like) {
    const auto found = std::find_if(state.begin(), state.end(), [&](const auto& entry) { return entry.first == name; });
    if (found == state.end() || found->second.sizes() != like.sizes())
      throw Error("file.unreadable", "The checkpoint's optimizer state " + name + " is missing or of another shape.");
    return found->second.to(like.options()).clone();
  };
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    auto& block = blocks_[i];
    const auto name = std::to_string(i) + "/";
    block.first = find(name + "first", block.first);
    block.second = find(name + "second", block.second);
    if (!block.has_bases || steps == 0) continue;
    block.left_statistics = find(name + "left_statistics", block.left_statistics);
    block.right_statistics = find(name + "right_statistics", block.right_statistics);
    block.left_basis = find(name + "left_basis", block.left_statistics);
    block.right_basis = find(name + "right_basis", block.right_statistics);
  }
  steps_ = steps;
}

}  // namespace supple::training
