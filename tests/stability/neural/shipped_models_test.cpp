// The shipped models, in cases that the training data hardly cover.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "supple/base/random.h"
#include "supple/neural/model.h"
#include "supple/neural/uniaxial.h"

namespace supple::neural {
namespace {

constexpr double half_turn = std::numbers::pi;

std::vector<std::string> shipped_models() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(SUPPLE_MODELS))
    if (entry.path().extension() == ".h5") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

Eigen::Matrix3d symmetric(const Eigen::Matrix<double, 6, 1>& c) {
  Eigen::Matrix3d m;
  m << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  return m;
}

class ShippedModels : public ::testing::TestWithParam<std::string> {
 protected:
  ShippedModels()
      : model_(read_model(std::filesystem::path(SUPPLE_MODELS) / (GetParam() + ".h5"))), evaluator_(model_.network) {}

  /// The corners of the box of parameters, and its middle.
  std::vector<std::vector<double>> corners() const {
    const auto n = model_.network.lower.size();
    std::vector<std::vector<double>> all;
    for (long bits = 0; bits < 1L << n; ++bits) {
      std::vector<double> corner;
      for (long k = 0; k < n; ++k)
        corner.push_back((bits >> k & 1) != 0 ? model_.network.upper[k] : model_.network.lower[k]);
      all.push_back(corner);
    }
    const Eigen::VectorXd middle = 0.5 * (model_.network.lower + model_.network.upper);
    all.emplace_back(middle.begin(), middle.end());
    return all;
  }

  Model model_;
  Evaluator evaluator_;
};

// Hard: energy and stress vanish, so that rounding errors are large relative to them.
TEST_P(ShippedModels, StrainsDownToRoundingAreLinearElasticity) {
  for (const auto& parameters : corners()) {
    const auto design = evaluator_.design(parameters);
    const auto rest = evaluator_.evaluate(design, Eigen::Vector3d::Zero(), Order::tangent);
    const Eigen::Matrix3d stiffness = symmetric(rest.tangent.col(0));
    EXPECT_LE(std::abs(rest.energy_density[0]), 1e-25 * stiffness.norm());
    EXPECT_LE(rest.stress.norm(), 1e-12 * stiffness.norm());
    EXPECT_GE(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(stiffness).eigenvalues()[0], -1e-12 * stiffness.norm());
    for (const double size : {1e-6, 1e-9, 1e-12}) {
      for (int i = 0; i < 3; ++i) {
        const Eigen::Vector3d e = size * Eigen::Vector3d::Unit(i);
        const auto answer = evaluator_.evaluate(design, e, Order::stress);
        const double curvature = 1e4 * size + 1e-14 / size;  // change of the stiffness, and rounding errors
        EXPECT_LE((answer.stress.col(0) - stiffness * e).norm(), curvature * stiffness.norm() * size) << size;
        EXPECT_GE(answer.energy_density[0], 0);
      }
    }
  }
}

// Hard: at corners, there are training data on one side only, and none beyond the ends of the range.
TEST_P(ShippedModels, UniaxialPathsToTheEndsOfTheRangeConvergeAtAllCorners) {
  for (const auto& parameters : corners()) {
    const auto design = evaluator_.design(parameters);
    for (int k = 0; k < 12; ++k) {
      for (const double end : {0.7, 1.5}) {
        std::vector<double> path;
        for (int i = 1; i <= 10; ++i) path.push_back(green_strain_of_stretch(1 + (end - 1) * i / 10));
        for (const auto& state : uniaxial_path(evaluator_, design, k * half_turn / 12, path)) {
          ASSERT_TRUE(state.converged) << "direction " << k << " of 12 to " << end;
          EXPECT_LE(state.residual, UniaxialOptions{}.tolerance);
          EXPECT_GT(state.energy_density, 0);
        }
      }
    }
  }
}

// Hard: only the end of the path is requested.
TEST_P(ShippedModels, OneJumpToAnEndOfTheRangeConverges) {
  RandomStream random("one jump " + GetParam(), 1);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> parameters;
    for (long k = 0; k < model_.network.lower.size(); ++k)
      parameters.push_back(random.uniform(model_.network.lower[k], model_.network.upper[k]));
    const double end = trial % 2 == 0 ? 0.7 : 1.5;
    const auto states = uniaxial_path(evaluator_, evaluator_.design(parameters), random.uniform(0, half_turn),
                                      std::vector{green_strain_of_stretch(end)});
    ASSERT_TRUE(states[0].converged) << "trial " << trial << " of seed 1";
    EXPECT_LE(states[0].residual, UniaxialOptions{}.tolerance);
  }
}

// Hard: networks extrapolate in an arbitrary manner. Results must be finite, and must not be called in range.
TEST_P(ShippedModels, FarOutsideAnswersAreFiniteAndFlagged) {
  auto far = corners().back();
  for (const double size : {2.0, 1e2, 1e4}) {
    const auto inside = evaluator_.design(far);
    const Eigen::Vector3d e(size, -0.3 * size, 0.2 * size);
    const auto answer = evaluator_.evaluate(inside, e, Order::third);
    EXPECT_TRUE(answer.energy_density.allFinite() && answer.stress.allFinite() && answer.tangent.allFinite() &&
                answer.third.allFinite());
    EXPECT_FALSE(in_range(model_, far, e, answer.energy_density[0], inside.rest_stiffness())) << size;
    auto outside = far;
    outside[0] = model_.network.upper[0] + size;
    const auto design = evaluator_.design(outside);
    const auto there = evaluator_.evaluate(design, Eigen::Vector3d(0.1, 0, 0), Order::tangent);
    EXPECT_TRUE(there.energy_density.allFinite() && there.tangent.allFinite());
    EXPECT_FALSE(in_range(model_, outside, {0.1, 0, 0}, there.energy_density[0], design.rest_stiffness()));
  }
}

// Hard: close to the strain at which the length along the load vanishes, there may be no equilibrium.
TEST_P(ShippedModels, NextToAVanishingLengthNothingIsClaimedThatIsNotReached) {
  for (const auto& parameters : corners()) {
    const auto states = uniaxial_path(evaluator_, evaluator_.design(parameters), 0.3, std::vector{-0.4999});
    EXPECT_TRUE(std::isfinite(states[0].energy_density));
    EXPECT_TRUE(!states[0].converged || states[0].residual <= UniaxialOptions{}.tolerance);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, ShippedModels, ::testing::ValuesIn(shipped_models()),
                         [](const auto& instance) { return instance.param; });

}  // namespace
}  // namespace supple::neural
