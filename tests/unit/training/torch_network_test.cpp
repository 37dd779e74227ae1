// Compares the evaluator and the kernels of the training with LibTorch's automatic differentiation.
#include "torch_network.h"

#include <gtest/gtest.h>
#include <torch/torch.h>

#include <string>
#include <vector>

#include "supple/neural/evaluator.h"
#include "support/random_network.h"

namespace supple::training {
namespace {

using neural::Activation;
using neural::EnergyForm;
using torch::Tensor;

neural::NetworkShape shape_of(EnergyForm form, Activation activation) {
  neural::NetworkShape shape;
  shape.form = form;
  shape.activation = activation;
  shape.width = 48;
  shape.parameters = 3;
  return shape;
}

neural::NetworkShape exact_at_rest(Activation activation, int features) {
  auto shape = shape_of(EnergyForm::sum_of_squares, activation);
  shape.rest = neural::RestForm::exact;
  shape.features = features;
  shape.stiffness_layers = 3;
  return shape;
}

class TorchNetwork : public ::testing::TestWithParam<neural::NetworkShape> {
 protected:
  neural::Network network = neural::random_network(GetParam(), 11);
};

Tensor column_tensor(const Eigen::VectorXd& values) {
  auto tensor = torch::empty({values.size()}, torch::kDouble);
  std::copy_n(values.data(), values.size(), tensor.data_ptr<double>());
  return tensor;
}

double largest(const Tensor& tensor) { return tensor.abs().max().item<double>(); }

/// All derivatives of the energy at one strain agree with those of automatic differentiation in double precision.
TEST_P(TorchNetwork, EvaluatorAgreesWithAutogradInDoublePrecision) {
  const auto parameters = to_parameters(network, torch::kDouble, torch::kCPU);
  const neural::Evaluator evaluator(network);
  RandomStream stream("autograd", 1);
  for (int trial = 0; trial < 5; ++trial) {
    Eigen::VectorXd p(3);
    for (int k = 0; k < 3; ++k) p[k] = stream.uniform(network.lower[k], network.upper[k]);
    const Eigen::Vector3d e(stream.uniform(-0.3, 0.4), stream.uniform(-0.3, 0.4), stream.uniform(-0.3, 0.4));
    const std::vector<double> at(p.begin(), p.end());
    const auto answer = evaluator.evaluate(evaluator.design(at, true), e, neural::Order::third);

    auto raw = column_tensor(p).set_requires_grad(true);
    const auto lower = column_tensor(network.lower);
    const auto upper = column_tensor(network.upper);
    auto strain = column_tensor(e).set_requires_grad(true);
    auto inputs = 2 * (raw - lower) / (upper - lower) - 1;
    if (network.shape.features > 0) {
      // LibTorch gets the features linearized at p, which have the right values and first derivatives there.
      const auto features = evaluate_features(network.geometry, at, true);
      const Eigen::MatrixXd slopes = features.rightCols(3);
      inputs = torch::cat({inputs, column_tensor(features.col(0))});
      for (int k = 0; k < 3; ++k) {
        const auto moved = torch::cat({torch::zeros({3}, torch::kDouble), column_tensor(slopes.col(k))});
        inputs = inputs + moved * (raw[k] - p[k]);
      }
    }
    const Batch batch{inputs.unsqueeze(0), torch::zeros({1}, torch::kLong), strain.unsqueeze(0)};
    const auto phi = energy(network.shape, parameters, batch)[0];
    const auto first = torch::autograd::grad({phi}, {strain, raw}, {}, true, true);
    const double tolerance = 1e-10;
    EXPECT_NEAR(answer.energy_density[0], phi.item<double>(), tolerance * phi.item<double>());
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(answer.stress(i, 0), first[0][i].item<double>(), tolerance * largest(first[0]));
      EXPECT_NEAR(answer.energy_by_parameters(i, 0), first[1][i].item<double>(), tolerance * largest(first[1]));
    }
    const int pair[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    for (int i = 0; i < 3; ++i) {
      const auto second = torch::autograd::grad({first[0][i]}, {strain, raw}, {}, true, true);
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(answer.tangent(pair[i][k], 0), second[0][k].item<double>(), tolerance * largest(second[0]));
        EXPECT_NEAR(answer.stress_by_parameters(3 * i + k, 0), second[1][k].item<double>(),
                    tolerance * largest(second[1]));
      }
      for (int j = i; j < 3; ++j) {
        const auto third = torch::autograd::grad({second[0][j]}, {strain, raw}, {}, true, true);
        for (int k = 0; k < 3; ++k)
          EXPECT_NEAR(answer.tangent_by_parameters(3 * pair[i][j] + k, 0), third[1][k].item<double>(),
                      tolerance * largest(third[1]));
        // Third derivatives 1jk are enough. The others equal them by symmetry, or are computed by the same channels.
        for (int k = j; i == 0 && k < 3; ++k)
          EXPECT_NEAR(answer.third(pair[j][k], 0), third[0][k].item<double>(), tolerance * largest(third[0]));
      }
    }
  }
}

/// A batch of 40 strains of 7 designs.
Batch random_batch(torch::Dtype type, int inputs) {
  torch::manual_seed(3);
  const auto options = torch::TensorOptions().dtype(torch::kDouble);
  return {(2 * torch::rand({7, inputs}, options) - 1).to(type), torch::randint(7, {40}, torch::kLong),
          (0.6 * torch::rand({40, 3}, options) - 0.25).to(type)};
}

TEST_P(TorchNetwork, TrainingKernelsAgreeWithAutograd) {
  const auto batch = random_batch(torch::kFloat, network.shape.design_inputs());
  const auto exact_batch = random_batch(torch::kDouble, network.shape.design_inputs());
  // Each row has its own direction.
  const auto directions = torch::rand({40, 3}, torch::kDouble) - 0.4;
  auto ours = to_parameters(network, torch::kFloat, torch::kCPU);
  auto exact = to_parameters(network, torch::kDouble, torch::kCPU);
  for (auto* parameters : {&ours, &exact})
    for (auto& tensor : *parameters) tensor.set_requires_grad(true);
  const auto a = response(network.shape, ours, batch, directions.to(torch::kFloat));
  const auto b = response_by_autograd(network.shape, exact, exact_batch, directions);
  const auto close = [](const Tensor& value, const Tensor& expected, double tolerance, const std::string& what) {
    EXPECT_LE(largest(value.to(torch::kDouble) - expected), tolerance * largest(expected)) << what;
  };
  close(a.energy, b.energy, 2e-5, "energy");
  close(a.stress, b.stress, 2e-5, "stress");
  close(a.stiffness, b.stiffness, 2e-4, "stiffness");
  // The gradients of a scalar are compared that depends on all answers, with fixed weights.
  const auto weights = torch::linspace(-1, 1, 40, torch::kDouble);
  const auto mix = [&](const Response& r) {
    const auto w = weights.to(r.energy.scalar_type());
    return (r.energy * w).sum() + (r.stress.square().sum(1) * w).sum() + (0.1 * r.stiffness * w).sum();
  };
  mix(a).backward();
  mix(b).backward();
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (!exact[i].grad().defined() || largest(exact[i].grad()) == 0) continue;
    close(ours[i].grad(), exact[i].grad(), 1e-3, "gradient of parameter " + std::to_string(i));
  }
}

/// A GPU computes jets without our kernels.
TEST_P(TorchNetwork, JetsWithoutOurKernelsAgreeWithAutograd) {
  const auto batch = random_batch(torch::kDouble, network.shape.design_inputs());
  const auto directions = torch::rand({40, 3}, torch::kDouble) - 0.4;
  const auto parameters = to_parameters(network, torch::kDouble, torch::kCPU);
  const auto a = response(network.shape, parameters, batch, directions);
  const auto b = response_by_autograd(network.shape, parameters, batch, directions);
  EXPECT_LE(largest(a.energy - b.energy), 1e-12 * largest(b.energy));
  EXPECT_LE(largest(a.stress - b.stress), 1e-12 * largest(b.stress));
  EXPECT_LE(largest(a.stiffness - b.stiffness), 1e-11 * largest(b.stiffness));
}

TEST_P(TorchNetwork, WeightsGoToTensorsAndBackUnchanged) {
  auto copy = network;
  for (auto& layer : copy.trunk) layer.weights.setZero();
  assign(copy, to_parameters(network, torch::kDouble, torch::kCPU));
  EXPECT_EQ(copy.trunk[2].weights, network.trunk[2].weights);
  EXPECT_EQ(copy.strain[0].bias, network.strain[0].bias);
}

INSTANTIATE_TEST_SUITE_P(Networks, TorchNetwork,
                         ::testing::Values(shape_of(EnergyForm::sum_of_squares, Activation::swish),
                                           shape_of(EnergyForm::sum_of_squares, Activation::tanh),
                                           shape_of(EnergyForm::sum_of_squares, Activation::sine),
                                           exact_at_rest(Activation::swish, 0), exact_at_rest(Activation::swish, 14),
                                           exact_at_rest(Activation::tanh, 10), exact_at_rest(Activation::sine, 0),
                                           shape_of(EnergyForm::softplus, Activation::swish)),
                         [](const auto& tested) { return neural::name_of(tested.param); });

}  // namespace
}  // namespace supple::training
