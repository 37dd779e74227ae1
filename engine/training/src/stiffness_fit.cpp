#include "stiffness_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "optimizer.h"
#include "stiffness_outputs.h"
#include "supple/base/random.h"
#include "supple/training/model_errors.h"
#include "training_batches.h"

namespace supple::training {
namespace {

using torch::Tensor;

constexpr double max_learning_rate = 3e-3;
constexpr double warm_up_steps = 50;
/// Relative errors of the factor below this value have less weight.
constexpr double error_floor = 2e-3;
constexpr double output_weight = 0.1;
/// Errors of the outputs below this value have less weight.
constexpr double output_floor = 0.1;
/// If there are at least so many designs, some are held out for validation.
constexpr long min_designs_with_validation = 200;
constexpr long designs_per_validation_design = 20;
/// Steps between reports.
constexpr int report_interval = 1000;
/// Designs that are evaluated at once for a report.
constexpr std::int64_t evaluation_batch = 4096;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

Tensor tensor_of(const Eigen::MatrixXd& columns) {
  auto tensor = torch::empty({columns.cols(), columns.rows()}, torch::kDouble);
  Eigen::Map<Eigen::MatrixXd>(tensor.data_ptr<double>(), columns.rows(), columns.cols()) = columns;
  return tensor.to(torch::kFloat);
}

/// The targets as tensors on the branch's device.
struct Tensors {
  Tensor inputs;   ///< designs x (parameters + features)
  Tensor outputs;  ///< designs x 6
  Tensor inverse;  ///< designs x 3 x 3: L*^-1
};

Tensors tensors_of(const StiffnessTargets& targets, torch::Device device) {
  Eigen::MatrixXd outputs(6, targets.designs());
  Eigen::MatrixXd inverse(9, targets.designs());
  for (long d = 0; d < targets.designs(); ++d) {
    const auto& factor = targets.factors[static_cast<std::size_t>(d)];
    outputs.col(d) = outputs_of(factor);
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = factor.inverse();
    inverse.col(d) = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(rows.data());
  }
  return {tensor_of(targets.inputs).to(device), tensor_of(outputs).to(device),
          tensor_of(inverse).reshape({-1, 3, 3}).to(device)};
}

/// The error max_v |v^T (L L^T - C*) v| / v^T C* v of each design. It is the largest deviation from 1 of an eigenvalue
/// of X X^T with X = L*^-1 L.
Eigen::VectorXd worst_errors(const Parameters& branch, const Tensors& tensors, const Tensor& designs) {
  const torch::NoGradGuard no_graph;
  Eigen::VectorXd errors(designs.size(0));
  for (std::int64_t begin = 0; begin < designs.size(0); begin += evaluation_batch) {
    const auto part = designs.slice(0, begin, std::min(begin + evaluation_batch, designs.size(0)));
    const auto factor = stiffness_factor(stiffness_outputs(branch, tensors.inputs.index_select(0, part)));
    const auto ratio =
        torch::matmul(tensors.inverse.index_select(0, part), factor).to(torch::kCPU, torch::kDouble).contiguous();
    for (std::int64_t i = 0; i < part.size(0); ++i) {
      const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> x(ratio.data_ptr<double>() + 9 * i);
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(x * x.transpose(), Eigen::EigenvaluesOnly);
      errors[begin + i] = (eigen.eigenvalues().array() - 1).abs().maxCoeff();
    }
  }
  return errors;
}

}  // namespace

StiffnessTargets stiffness_targets(const Samples& samples, const std::vector<RestStiffness>& rest,
                                   const std::vector<int>& held_out, const TrainingOptions& options) {
  const auto n = static_cast<long>(samples.lower.size());
  const auto mapped = [&](const Eigen::MatrixXd& parameters) { return design_inputs(samples, {}, parameters); };
  Eigen::MatrixXd held_out_inputs(n, static_cast<long>(held_out.size()));
  for (long j = 0; j < held_out_inputs.cols(); ++j) {
    const auto design = static_cast<std::size_t>(held_out[static_cast<std::size_t>(j)]);
    held_out_inputs.col(j) = Eigen::Map<const Eigen::VectorXd>(samples.designs[design].parameters.data(), n);
  }
  held_out_inputs = mapped(held_out_inputs);
  const auto symmetries = with_identity(options.symmetries, n);
  StiffnessTargets targets;
  std::vector<Eigen::VectorXd> parameters;
  for (const auto& design : rest) {
    const Eigen::Map<const Eigen::VectorXd> p(design.parameters.data(), n);
    const Eigen::VectorXd inputs = mapped(p);
    for (std::size_t s = 0; s < symmetries.size(); ++s) {
      const Eigen::VectorXd image = images(p, symmetries[s]);
      // The design itself is used wherever it lies, unless it is held out.
      if (s == 0 ? coincides(inputs, held_out_inputs) : !usable_image(inputs, mapped(image), held_out_inputs)) continue;
      const Eigen::Matrix3d map = symmetries[s].strain.inverse().transpose();
      const Eigen::LLT<Eigen::Matrix3d> factor(map * design.tangent * map.transpose());
      if (factor.info() != Eigen::Success) continue;
      parameters.push_back(image);
      targets.factors.emplace_back(factor.matrixL());
    }
  }
  Eigen::MatrixXd columns(n, static_cast<long>(parameters.size()));
  for (std::size_t d = 0; d < parameters.size(); ++d) columns.col(static_cast<long>(d)) = parameters[d];
  targets.inputs = design_inputs(samples, options.geometry, columns);
  return targets;
}

std::optional<StiffnessReport> fit_stiffness(Parameters& branch, const StiffnessTargets& targets,
                                             const TrainingOptions& options, bool set_mean_bias,
                                             const CancellationToken& cancellation,
                                             const std::function<void(const StiffnessReport&)>& report) {
  const double begin = now();
  const auto device = branch.front().device();
  const auto tensors = tensors_of(targets, device);
  const auto n = targets.designs();
  RandomStream stream("stiffness", static_cast<std::uint64_t>(options.seed));
  const auto shuffle = [&](std::vector<std::int64_t>& order) {
    for (std::size_t i = order.size(); i > 1; --i)
      std::swap(order[i - 1], order[static_cast<std::size_t>(stream.below(static_cast<int>(i)))]);
  };
  std::vector<std::int64_t> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), std::int64_t{0});
  // The images of a design follow it in the list. A contiguous range therefore holds out designs with their images.
  const long validation_count = n >= min_designs_with_validation ? n / designs_per_validation_design : 0;
  const auto index_tensor = [&](std::vector<std::int64_t> designs) { return torch::tensor(designs).to(device); };
  const auto validation = index_tensor({order.end() - validation_count, order.end()});
  order.resize(static_cast<std::size_t>(n - validation_count));
  const auto trained = index_tensor(order);
  if (set_mean_bias) {
    const torch::NoGradGuard no_graph;
    // The branch then has to learn deviations from the mean, which are of order one.
    branch.back().copy_(tensors.outputs.index_select(0, trained).mean(0));
  }
  StiffnessReport result{.designs = n};
  const auto measure = [&](int step) {
    result.step = step;
    result.seconds = now() - begin;
    const auto errors = worst_errors(branch, tensors, trained);
    result.trained_mean = errors.mean();
    result.trained_median = quantile(errors, 0.5);
    if (validation_count > 0) {
      const auto validation_errors = worst_errors(branch, tensors, validation);
      result.unseen_mean = validation_errors.mean();
      result.unseen_median = quantile(validation_errors, 0.5);
    }
    if (report) report(result);
  };
  Optimizer optimizer(OptimizerKind::soap, branch, branch.size());
  const auto unit = torch::eye(3, tensors.inputs.options());
  const auto batch = static_cast<std::size_t>(options.stiffness_batch);
  std::size_t next = order.size();
  for (int step = 0; step < options.stiffness_steps; ++step) {
    if (cancellation.requested()) return std::nullopt;
    if (next + batch > order.size()) {
      shuffle(order);
      next = 0;
    }
    const auto end = std::min(next + batch, order.size());
    const auto batch_designs = index_tensor(
        {order.begin() + static_cast<std::ptrdiff_t>(next), order.begin() + static_cast<std::ptrdiff_t>(end)});
    next = end;
    Parameters leaves;
    for (const auto& tensor : branch) leaves.push_back(tensor.detach().clone().set_requires_grad(true));
    const auto outputs = stiffness_outputs(leaves, tensors.inputs.index_select(0, batch_designs));
    const auto ratio = torch::matmul(tensors.inverse.index_select(0, batch_designs), stiffness_factor(outputs)) - unit;
    const auto error = torch::log1p((ratio.square().sum({1, 2}) + error_floor * error_floor).sqrt());
    const auto output_error =
        ((outputs - tensors.outputs.index_select(0, batch_designs)).square() + output_floor * output_floor)
            .sqrt()
            .mean(1);
    (error + output_weight * output_error).mean().backward();
    std::vector<Tensor> gradients;
    gradients.reserve(leaves.size());
    for (const auto& leaf : leaves) gradients.push_back(leaf.grad());
    const double fraction = static_cast<double>(step) / options.stiffness_steps;
    optimizer.step(gradients, max_learning_rate * 0.5 * (1 + std::cos(M_PI * fraction)) *
                                  std::min(1.0, (step + 1) / warm_up_steps));
    if ((step + 1) % report_interval == 0 && step + 1 < options.stiffness_steps) measure(step + 1);
  }
  measure(options.stiffness_steps);
  return result;
}

}  // namespace supple::training
