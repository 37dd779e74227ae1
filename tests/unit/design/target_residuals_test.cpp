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
    const auto [value, slope] = robust_deviation(d, c);
    EXPECT_NEAR(value * value, c * c * std::log1p(d * d / (c * c)), 1e-12 * value * value);
    EXPECT_GT(value * d, 0);
    const double step = 1e-5 * std::abs(d);
    EXPECT_NEAR(slope, (robust_deviation(d + step, c).value - robust_deviation(d - step, c).value) / (2 * step), 1e-8);
  }
}

TEST(Lessened, IsTheDeviationItselfNextToZero) {
  for (const double d : {0.0, 1e-300, -1e-12, 1e-8}) {
    EXPECT_EQ(robust_deviation(d, 0.1).value, d);
    EXPECT_EQ(robust_deviation(d, 0.1).slope, 1);
  }
  EXPECT_NEAR(robust_deviation(1.1e-7, 0.1).slope, 1, 1e-11) << "where the formula sets in";
}

/// Targets of two tasks that no design of these tests meets. Some deviations are far beyond the threshold of outliers.
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

/// The parameters are the threshold of outliers, and whether there is a correction. The correction's slope is as large
/// as the derivatives of the profiles.
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
  const Eigen::Vector2d x(start[0], start[1]);
  const Eigen::Vector3d all(x[0], x[1], 0);
  const Eigen::MatrixXd slope = Eigen::MatrixXd::NullaryExpr(
      13, 2, [](Eigen::Index row, Eigen::Index column) { return 0.5 * std::sin(1.0 + 3 * row + 7 * column); });
  const auto residuals = [&] {
    TargetResiduals made(test.evaluator, targets, {1, 2}, all, {0, 1}, 1e-12, {}, outlier);
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

/// Measurements of an imaginary structure: smooth nonlinear functions of the parameters.
StructureMeasures curved_measures(const Eigen::VectorXd& x) {
  return {0.3 + 0.2 * std::sin(x[0] + 2 * x[1]), 8 + x[0] * x[1]};
}

/// The modulus depends on the parameters, and both limits are violated, one of them from below.
TEST(TargetResiduals, HaveTheDerivativesOfTheBestModulusAndOfTheLimits) {
  const TestSpace test(2, 3);
  auto space = test.space();
  space.measure = curved_measures;
  auto targets = far_targets();
  targets[0].bands.setConstant(0.02);
  const auto start = test.at({0.4, 0.6});
  const Eigen::Vector2d x(start[0], start[1]);
  const Eigen::Vector3d all(x[0], x[1], 0);
  const auto here = curved_measures(x);
  const LimitResiduals limits(space, {{0, 0.8 * here.relative_density}, {1.3 * here.cell_size, 100}});
  const ModulusChoice moduli({{1, 1e5}}, test.model.provenance.youngs_modulus);
  for (const double outlier : {0.0, 0.1}) {
    const auto residuals = [&] {
      TargetResiduals made(test.evaluator, targets, {1, 2}, all, {0, 1}, 1e-12, {}, outlier);
      made.choose_among(moduli);
      made.add_limits(limits);
      return made;
    };
    auto at = residuals();
    Eigen::VectorXd r;
    ASSERT_TRUE(at.residuals(x, r));
    ASSERT_TRUE(at.chosen().is_inside);
    ASSERT_EQ(r.size(), 15);
    EXPECT_GT(r[13], 0);
    EXPECT_LT(r[14], 0);
    Eigen::MatrixXd jacobian;
    at.jacobian(jacobian);
    constexpr double step = 1e-5;
    for (Eigen::Index k = 0; k < 2; ++k) {
      Eigen::VectorXd above;
      Eigen::VectorXd below;
      ASSERT_TRUE(residuals().residuals(x + step * Eigen::VectorXd::Unit(2, k), above));
      ASSERT_TRUE(residuals().residuals(x - step * Eigen::VectorXd::Unit(2, k), below));
      const Eigen::VectorXd differences = (above - below) / (2 * step);
      EXPECT_LT((jacobian.col(k) - differences).head(13).norm(), 1e-5 * differences.head(13).norm()) << k;
      EXPECT_LT((jacobian.col(k) - differences).tail(2).norm(), 1e-3 * differences.tail(2).norm()) << k;
    }
  }
}

/// The targets have all three tasks.
TEST(TargetResiduals, HaveTheDerivativesByTheOrientation) {
  const TestSpace test(2, 3);
  auto targets = far_targets();
  Target stiffness;
  stiffness.task = Task::stiffness;
  stiffness.strain = 0.1;
  stiffness.measure = StrainMeasure::engineering;
  stiffness.control_points = {{0, 1}, {1, 3}, {2, 2}};
  stiffness.samples = 5;
  targets.push_back(sample_target(stiffness));
  const auto start = test.at({0.4, 0.6});
  const Eigen::Vector3d all(start[0], start[1], 0.7);
  const ModulusChoice moduli({{1, 1e5}}, test.model.provenance.youngs_modulus);
  const auto residuals = [&] {
    TargetResiduals made(test.evaluator, targets, {1, 2, 1}, all, {1, 2}, 1e-12);
    made.choose_among(moduli);
    return made;
  };
  const Eigen::Vector2d x = all.tail<2>();
  auto at = residuals();
  Eigen::VectorXd r;
  ASSERT_TRUE(at.residuals(x, r));
  Eigen::MatrixXd jacobian;
  at.jacobian(jacobian);
  ASSERT_EQ(jacobian.cols(), 2);
  constexpr double step = 1e-5;
  for (Eigen::Index k = 0; k < 2; ++k) {
    Eigen::VectorXd above;
    Eigen::VectorXd below;
    ASSERT_TRUE(residuals().residuals(x + step * Eigen::Vector2d::Unit(k), above));
    ASSERT_TRUE(residuals().residuals(x - step * Eigen::Vector2d::Unit(k), below));
    const Eigen::VectorXd differences = (above - below) / (2 * step);
    for (const auto& [first, count] : {std::pair{0, 6}, std::pair{6, 7}, std::pair{13, 5}})
      EXPECT_LT((jacobian.col(k) - differences).segment(first, count).norm(),
                1e-5 * differences.segment(first, count).norm())
          << k << " " << first;
  }
  // The same equilibria are found from a nearby state and from rest.
  Eigen::VectorXd followed;
  Eigen::VectorXd fresh;
  const Eigen::Vector2d away = x + Eigen::Vector2d(0.01, -0.3);
  ASSERT_TRUE(at.residuals(away, followed));
  ASSERT_TRUE(residuals().residuals(away, fresh));
  EXPECT_LT((followed - fresh).norm(), 1e-8 * fresh.norm());
}

TEST(TargetResiduals, AreZeroForLimitsThatAreKept) {
  const TestSpace test(2, 3);
  auto space = test.space();
  space.measure = curved_measures;
  const Eigen::Vector2d x(0.5, 0.5);
  const auto here = curved_measures(x);
  const auto rows = [&](const StructureLimits& limits) { return LimitResiduals(space, limits).at(x); };
  EXPECT_EQ(rows({}), Eigen::Vector2d::Zero());
  EXPECT_EQ(rows({{0.9 * here.relative_density, 1.1 * here.relative_density}, {0, 1.1 * here.cell_size}}),
            Eigen::Vector2d::Zero());
  // A limit that is met exactly violates the narrower limit of the penalty.
  EXPECT_GT(rows({{0, here.relative_density}, {}})[0], 0);
  EXPECT_LT(rows({{}, {here.cell_size, 100}})[1], 0);
  EXPECT_EQ(excess(space, {{0, here.relative_density}, {}}, x), "");
  EXPECT_NE(excess(space, {{0, 0.9 * here.relative_density}, {}}, x).find("above the greatest one asked for"),
            std::string::npos);
  EXPECT_NE(excess(space, {{}, {9, 10}}, x).find("below the least one asked for, 9"), std::string::npos);
}

TEST(TargetResiduals, CountsOutliersLess) {
  const TestSpace test(2, 3);
  const auto targets = far_targets();
  const auto start = test.at({0.4, 0.6});
  const Eigen::Vector2d x(start[0], start[1]);
  const Eigen::Vector3d all(x[0], x[1], 0);
  Eigen::VectorXd full;
  Eigen::VectorXd less;
  ASSERT_TRUE(TargetResiduals(test.evaluator, targets, {1, 2}, all, {0, 1}, 1e-12).residuals(x, full));
  ASSERT_TRUE(TargetResiduals(test.evaluator, targets, {1, 2}, all, {0, 1}, 1e-12, {}, 0.1).residuals(x, less));
  EXPECT_TRUE((less.array().abs() <= full.array().abs()).all());
  EXPECT_LT(less.norm(), 0.7 * full.norm());
}

}  // namespace
}  // namespace supple::design
