#include "optimizer.h"

#include <gtest/gtest.h>
#include <torch/torch.h>

#include <cmath>

#include "supple/base/error.h"
#include "supple/base/random.h"

namespace supple::training {
namespace {

using torch::Tensor;

Tensor random_matrix(long rows, long columns, std::uint64_t seed) {
  RandomStream stream("optimizer", seed);
  std::vector<float> numbers(static_cast<std::size_t>(rows * columns));
  for (auto& number : numbers) number = static_cast<float>(stream.normal());
  return torch::tensor(numbers).reshape({rows, columns});
}

/// The function |A (W - W*) B|^2 with ill-conditioned A and B. Its principal axes are not those of the entries of W, so
/// that Adam's scaling of entries does not help.
struct Bowl {
  Tensor a = scaled(random_matrix(32, 32, 1));
  Tensor b = scaled(random_matrix(16, 16, 2));
  Tensor target = random_matrix(32, 16, 3);

  static Tensor scaled(const Tensor& m) { return torch::mm(m, torch::diag(torch::logspace(-1.5, 0.3, m.size(1)))); }
  Tensor residual(const Tensor& w) const { return torch::mm(torch::mm(a, w - target), b); }
  double value(const Tensor& w) const { return residual(w).square().sum().item<double>(); }
  Tensor gradient(const Tensor& w) const { return 2 * torch::mm(torch::mm(a.t(), residual(w)), b.t()); }
};

double after_steps(OptimizerKind kind, int steps) {
  const Bowl bowl;
  Parameters parameters{torch::zeros({32, 16})};
  Optimizer optimizer(kind, parameters, 1);
  for (int i = 0; i < steps; ++i)
    optimizer.step({bowl.gradient(parameters[0])}, 0.03 * (1 - i / static_cast<double>(steps)));
  return bowl.value(parameters[0]);
}

TEST(Optimizer, EigenbasesHelpWhereTheValleyIsNotAlongTheAxes) {
  const double plain = after_steps(OptimizerKind::adam, 600);
  const double turned = after_steps(OptimizerKind::soap, 600);
  const Bowl bowl;
  EXPECT_LT(plain, bowl.value(torch::zeros({32, 16})));
  EXPECT_LT(turned, 0.2 * plain);
}

TEST(Optimizer, WeightsOfTheTrunkAloneDecayAndTheRateSaysHowFast) {
  for (const auto kind : {OptimizerKind::adam, OptimizerKind::soap}) {
    Parameters parameters{random_matrix(32, 16, 4), random_matrix(16, 1, 5).reshape({16}), random_matrix(8, 8, 6)};
    Parameters expected{parameters[0] * std::pow(1 - 0.01 * 0.5, 10), parameters[1].clone(), parameters[2].clone()};
    Optimizer optimizer(kind, parameters, 2, 0.5);
    for (int i = 0; i < 10; ++i)
      optimizer.step({torch::zeros({32, 16}), torch::zeros({16}), torch::zeros({8, 8})}, 0.01);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(torch::allclose(parameters[i], expected[i], 1e-5, 0));
  }
}

TEST(Optimizer, GoesOnFromItsStateWithTheSameBits) {
  const Bowl bowl;
  Parameters straight{torch::zeros({32, 16}), torch::zeros({16})};
  Optimizer one(OptimizerKind::soap, straight, 2);
  const auto step = [&](Optimizer& optimizer, Parameters& p) { optimizer.step({bowl.gradient(p[0]), p[1] - 1}, 0.01); };
  for (int i = 0; i < 70; ++i) step(one, straight);
  Parameters stopped{straight[0].clone(), straight[1].clone()};
  Optimizer other(OptimizerKind::soap, stopped, 2);
  other.restore(one.state(), one.steps());
  for (int i = 0; i < 60; ++i) {
    step(one, straight);
    step(other, stopped);
  }
  EXPECT_TRUE(torch::equal(straight[0], stopped[0]));
  EXPECT_TRUE(torch::equal(straight[1], stopped[1]));
}

TEST(Optimizer, AStateOfAnotherShapeIsRefused) {
  Parameters small{torch::zeros({8, 8})};
  Parameters large{torch::zeros({16, 8})};
  const Optimizer from(OptimizerKind::soap, small, 1);
  Optimizer to(OptimizerKind::soap, large, 1);
  EXPECT_THROW(to.restore(from.state(), 3), Error);
}

}  // namespace
}  // namespace supple::training
