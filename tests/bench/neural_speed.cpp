// Time of an evaluation against the rate of matrix products on this machine in the same run, and against LibTorch's
// automatic differentiation of the same network.
#include <torch/autograd.h>
#include <torch/types.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "measurement.h"
#include "neural_bench.h"
#include "report.h"
#include "supple/neural/evaluator.h"
#include "supple/neural/packed_matrix.h"
#include "support/random_network.h"
#include "torch_network.h"

namespace supple::bench {
namespace {

using neural::Order;

/// Least CPU seconds of one call, over `repetitions` of `calls` each.
template <class Action>
double least_time(int repetitions, int calls, Action&& action) {
  std::vector<double> times;
  for (int i = 0; i < repetitions; ++i)
    times.push_back(cpu_time([&] {
                      for (int j = 0; j < calls; ++j) action();
                    }) /
                    calls);
  return least(times);
}

/// Products of a strain with a square matrix, by order.
constexpr int products[] = {1, 2, 8, 20};

/// Multiply-adds of one strain: the square matrices, the first and the last layer, by order.
double multiply_adds(const neural::NetworkShape& shape, Order order) {
  const double width = shape.width;
  const double squares = (shape.strain_layers + shape.trunk_layers - 1) * width * width;
  return products[static_cast<int>(order)] * (squares + (3 + shape.outputs()) * width);
}

/// Multiply-adds a second of products of this width with many columns, by our kernel.
template <class Real>
double product_rate(int width, int repetitions) {
  const neural::PackedMatrix<Real> matrix(Eigen::MatrixXd::Random(width, width));
  const int columns = 48;
  const std::vector<Real> in(static_cast<std::size_t>(width * columns), Real(1));
  std::vector<Real> out(in.size());
  const double time = least_time(repetitions, 200, [&] {
    neural::multiply(matrix, {in.data(), width}, columns, out.data(), width);
  });
  return static_cast<double>(width) * width * columns / time;
}

struct Torch {
  neural::NetworkShape shape;
  training::Parameters parameters;
  training::Batch batch;

  /// Value, gradient and, up to `order`, Hessian by autograd, as one would write it with LibTorch.
  void evaluate(Order order) const {
    auto leaf = batch;
    leaf.e = batch.e.clone().set_requires_grad(order != Order::energy);
    const auto energy = training::energy(shape, parameters, leaf);
    if (order == Order::energy) return;
    const bool second = order == Order::tangent;
    const auto gradient = torch::autograd::grad({energy.sum()}, {leaf.e}, {}, second, second)[0];
    for (int i = 0; second && i < 3; ++i)
      (void)torch::autograd::grad({gradient.select(1, i).sum()}, {leaf.e}, {}, true, false);
  }
};

Torch torch_of(const neural::Network& network, const Eigen::Matrix3Xd& strains) {
  auto e = torch::empty({strains.cols(), 3}, torch::kDouble);
  std::copy_n(strains.data(), strains.size(), e.data_ptr<double>());
  return {
      network.shape,
      training::to_parameters(network, torch::kDouble, torch::kCPU),
      {torch::zeros({1, network.shape.parameters}, torch::kDouble), torch::zeros({strains.cols()}, torch::kLong), e}};
}

}  // namespace

void study_speed(const NeuralSettings& settings) {
  Report report(settings.folder, "models", "speed", "Time of an evaluation, beside LibTorch");
  Table table("models-speed", {{"width", "Width"},
                               {"strains", "Strains of one design"},
                               {"order", "Derivatives by strain"},
                               {"microseconds", "us a strain, double"},
                               {"floor", "Time over the floor"},
                               {"single_microseconds", "us a strain, single"},
                               {"single_error", "Largest relative error of single precision"},
                               {"torch_microseconds", "us a strain, LibTorch"},
                               {"ratio", "LibTorch over ours"}});
  Table designs("models-speed-designs", {{"width", "Width"},
                                         {"microseconds", "us a design"},
                                         {"with_derivatives", "us with derivatives by 4 parameters"}});
  const int repetitions = settings.brief ? 2 : 20;
  double floor_256 = 0;
  double ratio_one = 0;
  double ratio_fifty = 0;
  for (const int width : {64, 96, 128, 192, 256}) {
    neural::NetworkShape shape;
    shape.width = width;
    shape.parameters = 4;
    const auto network = neural::random_network(shape, 1);
    const neural::Evaluator evaluator(network);
    const neural::SingleEvaluator single(network);
    const std::vector<double> middle = [&] {
      const Eigen::VectorXd half = 0.5 * (network.lower + network.upper);
      return std::vector<double>(half.begin(), half.end());
    }();
    const auto design = evaluator.design(middle);
    const auto single_design = single.design(middle);
    neural::Evaluator::Workspace workspace;
    neural::SingleEvaluator::Workspace single_workspace;
    neural::Evaluation answer;
    neural::Evaluation rounded;
    const double rate = product_rate<double>(width, repetitions);
    for (const int strains : {1, 50}) {
      const Eigen::Matrix3Xd e = 0.2 * Eigen::Matrix3Xd::Random(3, strains);
      const auto torch = torch_of(network, e);
      for (const auto order : {Order::energy, Order::stress, Order::tangent, Order::third}) {
        const int calls = strains == 1 ? 100 : 5;
        const double time =
            least_time(repetitions, calls, [&] { evaluator.evaluate(design, e, order, workspace, answer); }) / strains;
        const double single_time =
            least_time(repetitions, calls,
                       [&] { single.evaluate(single_design, e, order, single_workspace, rounded); }) /
            strains;
        const auto& exact = order == Order::energy    ? Eigen::MatrixXd(answer.energy_density)
                            : order == Order::stress  ? Eigen::MatrixXd(answer.stress)
                            : order == Order::tangent ? Eigen::MatrixXd(answer.tangent)
                                                      : Eigen::MatrixXd(answer.third);
        const auto& less_exact = order == Order::energy    ? Eigen::MatrixXd(rounded.energy_density)
                                 : order == Order::stress  ? Eigen::MatrixXd(rounded.stress)
                                 : order == Order::tangent ? Eigen::MatrixXd(rounded.tangent)
                                                           : Eigen::MatrixXd(rounded.third);
        const double error =
            ((less_exact - exact).colwise().norm().array() / exact.colwise().norm().array()).maxCoeff();
        const double floor = time / (multiply_adds(shape, order) / rate);
        double torch_time = 0;
        if (order != Order::third)
          torch_time = least_time(std::min(repetitions, 10), 1, [&] { torch.evaluate(order); }) / strains;
        if (width == 256 && order == Order::tangent) {
          floor_256 = std::max(floor_256, floor);
          (strains == 1 ? ratio_one : ratio_fifty) = torch_time / time;
        }
        table.row({std::to_string(width), std::to_string(strains), std::to_string(static_cast<int>(order)),
                   number(1e6 * time), number(floor), number(1e6 * single_time), number(error, 2),
                   torch_time > 0 ? number(1e6 * torch_time) : "none",
                   torch_time > 0 ? number(torch_time / time) : "none"});
      }
    }
    designs.row({std::to_string(width),
                 number(1e6 * least_time(repetitions, 20, [&] { (void)evaluator.design(middle); })),
                 number(1e6 * least_time(repetitions, 20, [&] { (void)evaluator.design(middle, true); }))});
  }
  report.target("Value, gradient and Hessian at a width of 256, over the arithmetic's floor", "at most 2",
                number(floor_256), floor_256 <= 2);
  report.target("LibTorch's automatic differentiation over ours, one strain", "at least 20", number(ratio_one),
                ratio_one >= 20);
  report.target("The same, 50 strains of one design", "at least 3", number(ratio_fifty), ratio_fifty >= 3);
  report.heading("Strains");
  report.table(table);
  report.heading("Designs");
  report.text("What depends on the tiling parameters alone is computed once for each design.");
  report.table(designs);
  report.write(settings.command("speed"), settings.brief,
               "One thread, CPU time, least of " + std::to_string(repetitions) +
                   " repetitions; 3 + 3 + 5 hidden layers, swish, four parameters. The floor is the number of "
                   "multiply-adds (a strain meets seven square matrices once for the energy, twice with the stress, "
                   "eight times with the tangent, twenty times with third derivatives; the derivatives by the "
                   "parameters are on top) over the rate at which this machine multiplies a matrix of this width with "
                   "48 columns in the same run. LibTorch differentiates the same network in double precision, one "
                   "thread. The thesis reports 0.82 ms for energy, gradient and Hessian at a width of 256 on an RTX "
                   "3080.");
}

}  // namespace supple::bench
