#include "supple/design/profile.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "sampled_profile.h"
#include "support/expect_error.h"
#include "support/test_calibration.h"
#include "test_space.h"

namespace supple::design {
namespace {

using supple::testing::expect_error;
using supple::testing::places;

using std::numbers::pi;

Profile profile_of(const TestSpace& test, const std::vector<double>& parameters, const ProfileSamples& samples) {
  return evaluate_profile(test.model, test.evaluator, parameters, samples, 1e-13);
}

/// Components (xx, yy, xy) of d d^T, in the order of a stress.
Eigen::Vector3d dyad(double direction) {
  return {std::pow(std::cos(direction), 2), std::pow(std::sin(direction), 2),
          std::cos(direction) * std::sin(direction)};
}

TEST(Profile, OfAQuadraticEnergyIsWhatTheComplianceSays) {
  TestSpace test(2, 1);
  test.model.network.trunk.back().weights.setZero();
  const neural::Evaluator evaluator(test.model.network);
  const auto parameters = test.at({0.4, 0.6});
  const auto rest = evaluator.evaluate(evaluator.design(parameters), Eigen::Vector3d::Zero(), neural::Order::tangent);
  const Eigen::Matrix3d compliance = neural::symmetric_matrix(rest.tangent.col(0)).inverse();
  for (const double direction : {0.0, 0.7, 1.9}) {
    const double along = dyad(direction).dot(compliance * dyad(direction));
    const double across = dyad(direction + pi / 2).dot(compliance * dyad(direction));
    const auto value = [&](Task task, StrainMeasure measure) {
      ProfileSamples samples{task, direction, 0.1, measure, {task == Task::stress_strain ? 0.1 : direction}};
      return evaluate_profile(test.model, evaluator, parameters, samples).y[0];
    };
    EXPECT_NEAR(value(Task::stiffness, StrainMeasure::green), 1 / along, 1e-9 / along);
    EXPECT_NEAR(value(Task::poisson, StrainMeasure::green), -across / along, 1e-9);
    EXPECT_NEAR(value(Task::stress_strain, StrainMeasure::green), 0.1 / along, 1e-9 / along);
    // At a stretch of 1.1 the Green strain is 0.105, and the force over rest width is 1.1 times the stress.
    EXPECT_NEAR(value(Task::stress_strain, StrainMeasure::engineering), 1.1 * 0.105 / along, 1e-9 / along);
  }
}

TEST(Profile, StiffnessAndPoissonsRatioAreSlopesAlongTheLoadingPath) {
  const TestSpace test(2, 2);
  const auto parameters = test.at({0.2, 0.9});
  const double h = 1e-4;
  for (const double direction : {0.1, 1.2, 2.5}) {
    Equilibria<double> states(test.evaluator, {{direction, 0.2 - h}, {direction, 0.2 + h}}, {.tolerance = 1e-13});
    ASSERT_TRUE(states.from_rest(test.evaluator.design(parameters)));
    const auto& frame = states.frame(0);
    const double stiffness = (frame.directional(states[1].stress) - frame.directional(states[0].stress)) / (2 * h);
    const Eigen::Vector3d across(std::pow(std::sin(direction), 2), std::pow(std::cos(direction), 2),
                                 -std::sin(direction) * std::cos(direction));
    const double poisson = -across.dot(states[1].strain - states[0].strain) / (2 * h);
    EXPECT_NEAR(profile_of(test, parameters, {Task::stiffness, 0, 0.2, StrainMeasure::green, {direction}}).y[0],
                stiffness, 1e-6 * std::abs(stiffness));
    EXPECT_NEAR(profile_of(test, parameters, {Task::poisson, 0, 0.2, StrainMeasure::green, {direction}}).y[0], poisson,
                1e-6);
  }
}

TEST(Profile, RepeatsAfterHalfATurn) {
  const TestSpace test(1, 3);
  for (const Task task : {Task::stiffness, Task::poisson}) {
    const auto y = profile_of(test, test.at({0.3}), {task, 0, 0.1, StrainMeasure::green, {0.3, 0.3 + pi}}).y;
    EXPECT_NEAR(y[0], y[1], 1e-9 * std::abs(y[0]));
  }
}

TEST(Profile, TotalDerivativesAreTheDifferencesOfProfiles) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const TestSpace test(3, seed);
    const auto parameters = test.at({0.3, 0.6, 0.8});
    for (const Task task : {Task::stress_strain, Task::stiffness, Task::poisson}) {
      ProfileSamples profile{task, 0.8, 0.15, StrainMeasure::engineering, {-0.1, 0.05, 0.2, 0.3}};
      if (task != Task::stress_strain) profile.x = {0, 0.5, 1.4, 2.8};
      const auto samples = samples_of(profile);
      const auto design = test.evaluator.design(parameters, true);
      Equilibria<double> equilibria(test.evaluator, loadings_of(samples), {.tolerance = 1e-13});
      ASSERT_TRUE(equilibria.from_rest(design));
      Eigen::MatrixXd analytic;
      ValueDerivatives<double>().evaluate(test.evaluator, design, samples, equilibria, analytic);
      for (std::size_t p = 0; p < 3; ++p) {
        const double h = 1e-5;
        auto low = parameters;
        auto high = parameters;
        low[p] -= h;
        high[p] += h;
        const Eigen::VectorXd numeric =
            (profile_of(test, high, profile).y - profile_of(test, low, profile).y) / (2 * h);
        EXPECT_LT((numeric - analytic.col(static_cast<Eigen::Index>(p))).norm(), 1e-6 * numeric.norm() + 1e-9)
            << to_string(task) << ", seed " << seed << ", parameter " << p;
      }
    }
  }
}

TEST(Profile, ValuesOfStatesAreThoseOfTheProfile) {
  const TestSpace test(1, 5);
  const auto parameters = test.at({0.5});
  Equilibria<double> states(test.evaluator, {{0.6, 0.2}}, {});
  ASSERT_TRUE(states.from_rest(test.evaluator.design(parameters)));
  for (const Task task : {Task::stress_strain, Task::stiffness, Task::poisson}) {
    const ProfileSamples samples{task, 0.6, 0.2, StrainMeasure::green, {task == Task::stress_strain ? 0.2 : 0.6}};
    EXPECT_NEAR(profile_value(task, StrainMeasure::green, 0.6, 0.2, states[0].stress, states[0].tangent),
                profile_of(test, parameters, samples).y[0], 1e-8);
  }
}

TEST(Profile, SaysWhatLiesOutsideOfTheModelsRange) {
  const TestSpace test(1, 6);
  const auto profile = profile_of(test, test.at({0.5}), {Task::stress_strain, 0, 0, StrainMeasure::green, {0.1, 0.9}});
  EXPECT_EQ(profile.in_range, (std::vector<std::uint8_t>{1, 0}));
  EXPECT_EQ(profile_of(test, test.at({1.5}), {Task::stiffness, 0, 0.1, StrainMeasure::green, {0}}).in_range[0], 0);
}

TEST(Profile, HasErrorBarsInTheUnitOfItsValues) {
  TestSpace test(1, 6);
  const auto parameters = test.at({0.5});
  const auto ask = [&](Task task, StrainMeasure measure, std::vector<double> x) {
    return profile_of(test, parameters, {task, 0.2, 0.1, measure, std::move(x)});
  };
  EXPECT_EQ(ask(Task::poisson, StrainMeasure::green, {0.3}).error_bar.size(), 0) << "the model has none";
  test.model.calibration = supple::test::test_calibration(1);
  const auto stress = ask(Task::stress_strain, StrainMeasure::engineering, {-0.1, 0, 0.2, 0.9});
  ASSERT_EQ(stress.error_bar.size(), 4);
  EXPECT_NEAR(stress.error_bar[0], -0.02 * stress.y[0], 1e-12);
  EXPECT_LT(stress.error_bar[1], 1e-15) << "at rest there is no stress";
  EXPECT_NEAR(stress.error_bar[2], 0.02 * stress.y[2], 1e-12);
  EXPECT_TRUE(std::isnan(stress.error_bar[3])) << "beyond the strains of training";
  EXPECT_EQ(stress.in_range, (std::vector<std::uint8_t>{1, 1, 1, 0}));
  const auto stiffness = ask(Task::stiffness, StrainMeasure::green, {0.7});
  EXPECT_NEAR(stiffness.error_bar[0], 0.04 * stiffness.y[0], 1e-12);
  EXPECT_NEAR(ask(Task::poisson, StrainMeasure::green, {0.7}).error_bar[0], 0.06, 1e-12);
  EXPECT_EQ(ask(Task::poisson, StrainMeasure::green, {0.7}).in_range[0], 1);
  test.model.calibration->scales[2].given.offsets = {std::log(0.2)};
  EXPECT_EQ(ask(Task::poisson, StrainMeasure::green, {0.7}).in_range[0], 0) << "a bar of 0.2 is not trusted";
  EXPECT_EQ(ask(Task::stiffness, StrainMeasure::green, {0.7}).in_range[0], 1);
}

TEST(Profile, RefusesStrainsOfNoLength) {
  const TestSpace test(1, 6);
  const auto evaluate = [&](StrainMeasure measure, double strain) {
    profile_of(test, test.at({0.5}), {Task::stress_strain, 0, 0, measure, {0.1, strain}});
  };
  EXPECT_EQ(places(expect_error("model.invalid_load", [&] { evaluate(StrainMeasure::green, -0.5); })),
            std::vector<std::string>{"x/1"});
  EXPECT_EQ(places(expect_error("model.invalid_load", [&] { evaluate(StrainMeasure::engineering, -1); })),
            std::vector<std::string>{"x/1"});
  EXPECT_EQ(
      places(expect_error("model.invalid_load",
                          [&] {
                            profile_of(test, test.at({0.5}), {Task::stiffness, 0, -0.6, StrainMeasure::green, {0}});
                          })),
      std::vector<std::string>{"strain"});
}

}  // namespace
}  // namespace supple::design
