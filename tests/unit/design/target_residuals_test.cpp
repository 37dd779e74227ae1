#include "target_residuals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <tuple>

#include "test_space.h"

namespace supple::design {
namespace {

TEST(Lessened, IsCauchysFunctionWithItsSignAndSlope) {
  const double c = 0.1;
  for (const double d : {-3.0, -0.1, -1e-3, 1e-4, 0.07, 0.5, 20.0}) {
    const auto [value, slope] = lessened(d, c);
    EXPECT_NEAR(value * value, c * c * std::log1p(d * d / (c * c)), 1e-12 * value * value);
    EXPECT_GT(value * d, 0);
    const double step = 1e-5 * std::abs(d);
    EXPECT_NEAR(slope, (lessened(d + step, c).value - lessened(d - step, c).value) / (2 * step), 1e-8);
  }
}

TEST(Lessened, IsTheDeviationItselfNextToZero) {
  for (const double d : {0.0, 1e-300, -1e-12, 1e-8}) {
    EXPECT_EQ(lessened(d, 0.1).value, d);
    EXPECT_EQ(lessened(d, 0.1).slope, 1);
  }
  EXPECT_NEAR(lessened(1.1e-7, 0.1).slope, 1, 1e-11) << "where the formula sets in";
}

/// Targets of two tasks that no design of the tests has, some of their deviations far beyond the outliers' share.
std::vector<SampledTarget> far_targets() {
  Target stress;
  stress.direction = 0.4;
  stress.control_points = {{-0.1, -0.3}, {0, 0}, {0.1, 2}};
  stress.samples = 6;
  Target poisson;
  poisson.task = Task::poisson;
  poisson.control_points = {{0, 0.3}, {1, 0.2}, {2, -0.4}};
  poisson.samples = 7;
  poisson.weight = 2;
  return {sample_target(stress), sample_target(poisson)};
}

/// Also of a correction, whose slope is as large as the profiles' own.
class Derivatives : public ::testing::TestWithParam<std::tuple<double, bool>> {};
INSTANTIATE_TEST_SUITE_P(TargetResiduals, Derivatives,
                         ::testing::Combine(::testing::Values(0.0, 0.1), ::testing::Bool()));

TEST_P(Derivatives, AreThoseThatDifferencesGive) {
  const auto [outlier_share, corrected] = GetParam();
  const double outlier = outlier_share;
  const bool has_correction = corrected;
  const TestSpace test(2, 3);
  const auto targets = far_targets();
  const auto start = test.at({0.4, 0.6});
  const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(start.data(), 2);
  const Eigen::MatrixXd slope = Eigen::MatrixXd::NullaryExpr(
      13, 2, [](Eigen::Index row, Eigen::Index column) { return 0.5 * std::sin(1.0 + 3 * row + 7 * column); });
  const auto residuals = [&] {
    TargetResiduals made(test.evaluator, targets, {1, 2}, x, {0, 1}, 1e-12, {}, outlier);
    if (has_correction) made.correct({Eigen::VectorXd::LinSpaced(13, -0.02, 0.03), slope, x});
    return made;
  };
  auto at = residuals();
  Eigen::VectorXd r;
  ASSERT_TRUE(at.residuals(x, r));
  Eigen::MatrixXd jacobian;
  at.jacobian(jacobian);
  constexpr double step = 1e-5;
  for (Eigen::Index k = 0; k < 2; ++k) {
    Eigen::VectorXd above;
    Eigen::VectorXd below;
    ASSERT_TRUE(residuals().residuals(x + step * Eigen::VectorXd::Unit(2, k), above));
    ASSERT_TRUE(residuals().residuals(x - step * Eigen::VectorXd::Unit(2, k), below));
    const Eigen::VectorXd differences = (above - below) / (2 * step);
    EXPECT_LT((jacobian.col(k) - differences).norm(), 1e-5 * differences.norm()) << k;
  }
}

TEST(TargetResiduals, CountsOutliersLess) {
  const TestSpace test(2, 3);
  const auto targets = far_targets();
  const auto start = test.at({0.4, 0.6});
  const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(start.data(), 2);
  Eigen::VectorXd full;
  Eigen::VectorXd less;
  ASSERT_TRUE(TargetResiduals(test.evaluator, targets, {1, 2}, x, {0, 1}, 1e-12).residuals(x, full));
  ASSERT_TRUE(TargetResiduals(test.evaluator, targets, {1, 2}, x, {0, 1}, 1e-12, {}, 0.1).residuals(x, less));
  EXPECT_TRUE((less.array().abs() <= full.array().abs()).all());
  EXPECT_LT(less.norm(), 0.7 * full.norm());
}

}  // namespace
}  // namespace supple::design
