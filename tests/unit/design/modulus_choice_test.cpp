#include "modulus_choice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "supple/design/design_fault.h"
#include "support/expect_error.h"

namespace supple::design {
namespace {

using supple::testing::expect_error;
using supple::testing::places;

SampledTarget target_with(Task task, const Eigen::VectorXd& y, double band = 0) {
  SampledTarget target;
  target.samples.task = task;
  target.samples.x.resize(static_cast<std::size_t>(y.size()));
  target.y = y;
  target.weights = Eigen::VectorXd::LinSpaced(y.size(), 1, 2);
  target.weights /= target.weights.sum();
  target.bands = Eigen::VectorXd::Constant(y.size(), band);
  target.scale = std::sqrt(target.weights.dot(y.cwiseAbs2()));
  return target;
}

/// Values of a model with a modulus of 26 MPa, and two targets: stresses near 2.5 times the values, and Poisson's
/// ratios, which no modulus changes.
struct Example {
  explicit Example(double band = 0) {
    targets.push_back(
        target_with(Task::stress_strain, 2.5 * values.head(4) + Eigen::Vector4d(0.1, -0.2, 0.05, 0.3), band));
    targets.push_back(target_with(Task::poisson, Eigen::Vector3d(0.3, 0.2, 0.1)));
  }
  /// The weighted sum of the squared deviations beyond the bands.
  double misfit(double factor) const {
    const Eigen::VectorXd compared = scaled(targets, values, factor);
    return weights[0] * std::pow(*targets[0].relative_rms(compared.head(4)), 2) +
           weights[1] * std::pow(*targets[1].relative_rms(compared.tail(3)), 2);
  }
  Eigen::VectorXd values = (Eigen::VectorXd(7) << -1, 0.5, 2, 3, 0.9, 0.8, 0.7).finished();
  std::vector<SampledTarget> targets;
  std::vector<double> weights{1, 3};
};

TEST(ModulusChoice, TakesTheModulusWithTheLeastDeviation) {
  for (const double band : {0.0, 0.1, 0.25}) {
    const Example example(band);
    const auto chosen = ModulusChoice({{26, 260}}, 26).best(example.targets, example.weights, example.values);
    EXPECT_TRUE(chosen.is_inside);
    EXPECT_DOUBLE_EQ(chosen.modulus, 26 * chosen.factor);
    for (int i = 0; i <= 900; ++i) EXPECT_LE(example.misfit(chosen.factor), example.misfit(1 + 0.01 * i) + 1e-15) << i;
  }
}

TEST(ModulusChoice, StaysWithinItsRangeToTheLastDigit) {
  const Example example;
  const auto low = ModulusChoice({{0.1, 0.3}}, 26).best(example.targets, example.weights, example.values);
  EXPECT_EQ(low.modulus, 0.3);
  EXPECT_FALSE(low.is_inside);
  const auto high = ModulusChoice({{700, 900}}, 26).best(example.targets, example.weights, example.values);
  EXPECT_EQ(high.modulus, 700);
  const auto one = ModulusChoice({{12.7, 12.7}}, 26).best(example.targets, example.weights, example.values);
  EXPECT_EQ(one.modulus, 12.7);
  EXPECT_EQ(one.factor, 12.7 / 26);
}

TEST(ModulusChoice, TakesTheBestOfSeveralMaterials) {
  const Example example;
  const ModulusChoice choice({{1, 1}, {5, 40}, {50, 80}, {1000, 1000}}, 26);
  const auto chosen = choice.best(example.targets, example.weights, example.values);
  EXPECT_EQ(chosen.material, 2U);
  EXPECT_TRUE(chosen.is_inside);
  EXPECT_EQ(choice.limits(), (std::pair{1 / 26.0, 1000 / 26.0}));
  EXPECT_FALSE(choice.single());
  EXPECT_EQ(ModulusChoice({}, 26).single(), 1);
}

TEST(ModulusChoice, LooksPastSamplesWithoutEquilibrium) {
  Example example;
  const ModulusChoice choice({{26, 260}}, 26);
  example.targets[0].y[3] = 2.5 * 3;
  const double before = choice.best(example.targets, example.weights, example.values).factor;
  example.values[0] = std::numeric_limits<double>::quiet_NaN();
  const double after = choice.best(example.targets, example.weights, example.values).factor;
  EXPECT_NE(before, after);
  EXPECT_NEAR(after, 2.5, 0.1);
}

TEST(ModulusChoice, KnowsHowItFollowsTheValues) {
  for (const double band : {0.0, 0.1}) {
    const Example example(band);
    const ModulusChoice choice({{26, 260}}, 26);
    const Eigen::MatrixXd derivatives = Eigen::MatrixXd::NullaryExpr(
        7, 2, [](Eigen::Index row, Eigen::Index column) { return std::cos(row + 5 * column); });
    const auto at = [&](const Eigen::Vector2d& x) {
      return choice.best(example.targets, example.weights, example.values + derivatives * x);
    };
    const auto slope = choice.slope(example.targets, example.weights, example.values, derivatives, at({0, 0}));
    constexpr double step = 1e-6;
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector2d away = step * Eigen::Vector2d::Unit(k);
      EXPECT_NEAR(slope[k], (at(away).factor - at(-away).factor) / (2 * step), 1e-7) << band << " " << k;
    }
  }
}

TEST(ModulusChoice, RefusesRangesThatAreNone) {
  for (const Range& range : {Range{0, 1}, Range{2, 1}, Range{1, std::numeric_limits<double>::infinity()}}) {
    const auto error = expect_error<DesignFault>("design.invalid_modulus", [&] { ModulusChoice({{1, 2}, range}, 26); });
    EXPECT_EQ(places(error), std::vector<std::string>{"moduli/1"});
  }
}

}  // namespace
}  // namespace supple::design
