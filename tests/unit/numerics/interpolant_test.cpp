#include "supple/numerics/interpolant.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace supple::numerics {
namespace {

using std::numbers::pi;
const std::vector<double> xs{0, 0.3, 0.5, 1.1, 1.2};
const std::vector<double> ys{1, 2, -1, 0.5, 0.4};

/// Second derivative by differences on one side of x.
double curvature(const Interpolant& curve, double x, double h) {
  return (curve(x) - 2 * curve(x + h) + curve(x + 2 * h)) / (h * h);
}

class EveryKind : public ::testing::TestWithParam<Interpolation> {};
INSTANTIATE_TEST_SUITE_P(Interpolant, EveryKind,
                         ::testing::Values(Interpolation::cubic, Interpolation::monotone, Interpolation::linear),
                         [](const auto& kind) { return std::string(to_string(kind.param)); });

TEST_P(EveryKind, PassesThroughItsPoints) {
  const Interpolant open(xs, ys, GetParam());
  const Interpolant closed(xs, ys, GetParam(), pi);
  for (std::size_t i = 0; i < xs.size(); ++i) {
    EXPECT_NEAR(open(xs[i]), ys[i], 1e-14);
    EXPECT_NEAR(closed(xs[i]), ys[i], 1e-14);
    EXPECT_NEAR(closed(xs[i] + 5 * pi), ys[i], 1e-12);
  }
}

TEST_P(EveryKind, RepeatsAStraightLineAlsoBeyondItsEnds) {
  const std::vector<double> line{2, 2.6, 3, 4.2, 4.4};
  const Interpolant curve(xs, line, GetParam());
  for (double x = -1; x < 2; x += 0.1) EXPECT_NEAR(curve(x), 2 + 2 * x, 1e-12);
}

TEST_P(EveryKind, GoesOnAlongItsTangentsBeyondItsEnds) {
  const Interpolant curve(xs, ys, GetParam());
  const double h = 1e-6;
  const double first = (curve(xs.front() + h) - ys.front()) / h;
  const double last = (ys.back() - curve(xs.back() - h)) / h;
  for (const double beyond : {0.1, 2.0}) {
    EXPECT_NEAR(curve(xs.front() - beyond), ys.front() - beyond * first, 1e-4);
    EXPECT_NEAR(curve(xs.back() + beyond), ys.back() + beyond * last, 1e-4);
  }
}

TEST_P(EveryKind, IsConstantThroughOnePoint) {
  const std::vector<double> one{0.4};
  EXPECT_EQ(Interpolant(one, one, GetParam())(7), 0.4);
  EXPECT_NEAR(Interpolant(one, one, GetParam(), pi)(7), 0.4, 1e-15);
}

TEST(Interpolant, ACubicSplineHasContinuousCurvatureAndNoneAtItsEnds) {
  const double h = 1e-4;
  const Interpolant open(xs, ys, Interpolation::cubic);
  for (std::size_t i = 1; i + 1 < xs.size(); ++i)
    EXPECT_NEAR(curvature(open, xs[i], -h), curvature(open, xs[i], h), 0.3) << i;
  EXPECT_NEAR(curvature(open, xs.front(), h), 0, 0.3);
  const Interpolant closed(xs, ys, Interpolation::cubic, pi);
  EXPECT_NEAR(curvature(closed, xs.front(), -h), curvature(closed, xs.front(), h), 0.3);
  EXPECT_GT(std::abs(curvature(closed, xs.front(), h)), 1);
}

TEST(Interpolant, APeriodicCubicSplineFollowsACosineToFourthOrder) {
  const auto worst = [](int points) {
    std::vector<double> x;
    std::vector<double> y;
    for (int i = 0; i < points; ++i) {
      x.push_back(i * pi / points);
      y.push_back(std::cos(2 * x.back()));
    }
    const Interpolant curve(x, y, Interpolation::cubic, pi);
    double error = 0;
    for (double t = 0; t < pi; t += 0.001) error = std::max(error, std::abs(curve(t) - std::cos(2 * t)));
    return error;
  };
  EXPECT_LT(worst(16), 4e-4);
  EXPECT_NEAR(std::log2(worst(16) / worst(32)), 4, 0.2);
}

TEST(Interpolant, AMonotoneCurveStaysBetweenNeighbouringPoints) {
  for (const auto& period : {std::optional<double>(), std::optional<double>(pi)}) {
    const Interpolant curve(xs, ys, Interpolation::monotone, period);
    for (std::size_t i = 0; i + 1 < xs.size(); ++i)
      for (double t = 0; t <= 1; t += 0.01) {
        const double y = curve(xs[i] + t * (xs[i + 1] - xs[i]));
        EXPECT_GE(y, std::min(ys[i], ys[i + 1]) - 1e-14);
        EXPECT_LE(y, std::max(ys[i], ys[i + 1]) + 1e-14);
      }
  }
}

}  // namespace
}  // namespace supple::numerics
