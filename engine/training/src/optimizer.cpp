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
constexpr double adam_epsilon = 1e-8;
/// Steps between updates of the bases.
constexpr std::int64_t basis_interval = 50;
/// Steps between updates of the statistics, whose eigenvectors are the bases.
constexpr std::int64_t statistics_interval = 4;
constexpr double statistics_decay = 0.96;
/// Columns of a block of a matrix. Smaller blocks make the eigenvectors cheaper.
constexpr std::int64_t max_columns = 256;

/// Eigenvectors of a symmetric matrix as columns.
Tensor eigenvectors(const Tensor& symmetric) {
  const auto n = symmetric.size(0);
  const auto exact = symmetric.to(torch::kCPU, torch::kDouble).contiguous();
  const Eigen::Map<const Eigen::MatrixXd> matrix(exact.data_ptr<double>(), n, n);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  auto vectors = torch::empty({n, n}, torch::kDouble);
  // Eigen stores columns where LibTorch has rows, so that the tensor holds the transpose.
  Eigen::Map<Eigen::MatrixXd>(vectors.data_ptr<double>(), n, n) = solver.eigenvectors();
  return vectors.t().contiguous().to(symmetric.options());
}

/// Updates Adam's moments by the gradient g, and returns Adam's direction. The corrections 1 - decay^t remove the bias
/// of the moments' zero start.
Tensor adam_direction(Tensor& first_moment, Tensor& second_moment, const Tensor& g, double first_correction,
                      double second_correction) {
  if (!supported_by_kernels(g)) {
    first_moment.mul_(first_decay).add_(g, 1 - first_decay);
    second_moment.mul_(second_decay).addcmul_(g, g, 1 - second_decay);
    return first_moment / first_correction / (second_moment / second_correction).sqrt_().add_(adam_epsilon);
  }
  // One pass over the numbers instead of nine.
  auto direction = torch::empty_like(first_moment);
  const auto contiguous_g = g.contiguous();
  const float* gradient = contiguous_g.data_ptr<float>();
  float* first_values = first_moment.data_ptr<float>();
  float* second_values = second_moment.data_ptr<float>();
  float* step = direction.data_ptr<float>();
  const auto first_factor = static_cast<float>(1 / first_correction);
  const auto second_factor = static_cast<float>(1 / second_correction);
  constexpr auto decay = static_cast<float>(first_decay);
  constexpr auto square_decay = static_cast<float>(second_decay);
  for (std::int64_t i = 0; i < first_moment.numel(); ++i) {
    first_values[i] = decay * first_values[i] + (1 - decay) * gradient[i];
    second_values[i] = square_decay * second_values[i] + (1 - square_decay) * gradient[i] * gradient[i];
    step[i] = first_factor * first_values[i] /
              (std::sqrt(second_factor * second_values[i]) + static_cast<float>(adam_epsilon));
  }
  return direction;
}

}  // namespace

Optimizer::Optimizer(OptimizerKind kind, Parameters& parameters, std::size_t preconditioned, double weight_decay)
    : kind_(kind), parameters_(parameters), weight_decay_(weight_decay) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const bool inner_matrix = i < preconditioned && parameters[i].dim() == 2;
    const auto columns = parameters[i].dim() == 2 ? parameters[i].size(1) : 0;
    for (std::int64_t begin = 0; begin < std::max<std::int64_t>(columns, 1); begin += max_columns) {
      Block block;
      block.parameter = i;
      block.column = begin;
      block.columns = std::min(columns - begin, max_columns);
      block.has_bases = inner_matrix && kind == OptimizerKind::soap;
      block.has_weight_decay = inner_matrix && weight_decay > 0;
      const auto view = block_view(block, parameters[i]).detach();
      block.first_moment = torch::zeros_like(view, torch::MemoryFormat::Contiguous);
      block.second_moment = torch::zeros_like(view, torch::MemoryFormat::Contiguous);
      if (block.has_bases) {
        block.left_statistics = torch::zeros({view.size(0), view.size(0)}, view.options());
        block.right_statistics = torch::zeros({view.size(1), view.size(1)}, view.options());
      }
      blocks_.push_back(std::move(block));
    }
  }
}

Tensor Optimizer::block_view(const Block& block, const Tensor& tensor) {
  return tensor.dim() == 2 ? tensor.narrow(1, block.column, block.columns) : tensor;
}

void Optimizer::step(const std::vector<Tensor>& gradients, double learning_rate) {
  ++steps_;
  parallel_for(static_cast<int>(blocks_.size()), [&](int i) {
    const torch::NoGradGuard no_graph;
    auto& block = blocks_[static_cast<std::size_t>(i)];
    step(block, block_view(block, gradients[block.parameter]), learning_rate);
  });
}

void Optimizer::step(Block& block, const Tensor& gradient, double learning_rate) const {
  Tensor g = gradient;
  if (block.has_bases) {
    if (steps_ % statistics_interval == 1) {
      block.left_statistics.mul_(statistics_decay).add_(product(g, false, g, true), 1 - statistics_decay);
      block.right_statistics.mul_(statistics_decay).add_(product(g, true, g, false), 1 - statistics_decay);
    }
    if (steps_ == 1 || steps_ % basis_interval == 0) update_bases(block);
    g = product(product(block.left_basis, true, g, false), false, block.right_basis, false);
  }
  const auto t = static_cast<double>(steps_);
  Tensor change = adam_direction(block.first_moment, block.second_moment, g, 1 - std::pow(first_decay, t),
                                 1 - std::pow(second_decay, t));
  if (block.has_bases)
    change = product(product(block.left_basis, false, change, false), false, block.right_basis, true);
  auto values = block_view(block, parameters_[block.parameter]);
  if (block.has_weight_decay) values.mul_(1 - learning_rate * weight_decay_);
  values.add_(change, -learning_rate);
}

void Optimizer::update_bases(Block& block) const {
  const auto left = eigenvectors(block.left_statistics);
  const auto right = eigenvectors(block.right_statistics);
  if (block.left_basis.defined()) {
    const auto change_left = product(left, true, block.left_basis, false);
    const auto change_right = product(block.right_basis, true, right, false);
    block.first_moment =
        product(product(change_left, false, block.first_moment, false), false, change_right, false).contiguous();
    block.second_moment =
        product(product(change_left.square(), false, block.second_moment, false), false, change_right.square(), false)
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
    add("first", block.first_moment);
    add("second", block.second_moment);
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
    block.first_moment = find(name + "first", block.first_moment);
    block.second_moment = find(name + "second", block.second_moment);
    if (!block.has_bases || steps == 0) continue;
    block.left_statistics = find(name + "left_statistics", block.left_statistics);
    block.right_statistics = find(name + "right_statistics", block.right_statistics);
    block.left_basis = find(name + "left_basis", block.left_statistics);
    block.right_basis = find(name + "right_basis", block.right_statistics);
  }
  steps_ = steps;
}

}  // namespace supple::training
