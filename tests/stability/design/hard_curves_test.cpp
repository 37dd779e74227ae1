// Measured curves that are hard to reduce to control points: extreme scales, jumps, crowded samples, points in any
// order. Each gives increasing, finite control points whose curve stays near the data.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "supple/base/error.h"
#include "supple/design/measured_curve.h"

namespace supple::design {
namespace {

double j_curve(double x) { return 0.2 * x + 0.02 * (std::exp(18 * x) - 1); }

MeasuredCurve curve_of(const std::vector<double>& x, double (*f)(double)) {
  MeasuredCurve curve;
  for (const double at : x) curve.points.emplace_back(at, f(at));
  return curve;
}

std::vector<double> evenly(double lower, double upper, int count) {
  std::vector<double> x;
  for (int i = 0; i < count; ++i) x.push_back(lower + (upper - lower) * i / (count - 1));
  return x;
}

/// Expects finite control points with increasing x. The curve may leave the range of the data by the fraction `beyond`
/// of its height.
ReducedCurve expect_sense(const MeasuredCurve& curve, double beyond, const ReductionOptions& options = {}) {
  ReducedCurve reduced = reduce(curve, options);
  EXPECT_GE(reduced.control_points.size(), 2U);
  EXPECT_LE(reduced.control_points.size(), static_cast<std::size_t>(options.max_control_points));
  std::vector<double> x, y;
  for (const auto& point : reduced.control_points) {
    EXPECT_TRUE(point.allFinite());
    EXPECT_TRUE(x.empty() || point.x() > x.back());
    x.push_back(point.x());
    y.push_back(point.y());
  }
  EXPECT_TRUE(std::isfinite(reduced.relative_rms));
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const auto& point : reduced.points) {
    least = std::min(least, point.y());
    most = std::max(most, point.y());
  }
  const numerics::Interpolant interpolant(x, y, reduced.interpolation, std::nullopt);
  for (const double at : evenly(x.front(), x.back(), 997)) {
    const double value = interpolant(at);
    EXPECT_GE(value, least - beyond * (most - least)) << "at " << at;
    EXPECT_LE(value, most + beyond * (most - least)) << "at " << at;
  }
  return reduced;
}

TEST(HardCurves, AnyUnitOfStressGivesTheSameCurve) {
  const MeasuredCurve curve = curve_of(evenly(0, 0.15, 300), j_curve);
  const ReducedCurve reduced = expect_sense(curve, 0.02);
  for (const double factor : {1e-12, 1e-3, 1e4}) {
    MeasuredCurve scaled = curve;
    for (auto& point : scaled.points) point.y() *= factor;
    const ReducedCurve same = reduce(scaled, {});
    ASSERT_EQ(same.control_points.size(), reduced.control_points.size()) << factor;
    EXPECT_NEAR(same.relative_rms, reduced.relative_rms, 1e-6 * reduced.relative_rms) << factor;
    for (std::size_t i = 0; i < same.control_points.size(); ++i)
      EXPECT_NEAR(same.control_points[i].y(), factor * reduced.control_points[i].y(), 1e-6 * factor) << factor;
  }
}

TEST(HardCurves, StrainsOfAnyRange) {
  for (const double range : {1e-9, 1e-4, 10.0, 1e6}) {
    MeasuredCurve curve;
    for (const double t : evenly(0, 1, 300)) curve.points.emplace_back(range * t, j_curve(0.15 * t));
    EXPECT_LE(expect_sense(curve, 0.02).relative_rms, 0.01) << range;
  }
}

TEST(HardCurves, AJumpOfTheStress) {
  // A cell wall snaps through: the stress falls to a third from one sample to the next.
  const auto snap = [](double x) { return x < 0.07 ? 12 * x : 4 * x; };
  ReductionOptions options;
  options.max_control_points = 24;
  const ReducedCurve reduced = expect_sense(curve_of(evenly(0, 0.15, 400), snap), 0.1, options);
  EXPECT_LE(reduced.relative_rms, 0.1);
}

TEST(HardCurves, SamplesThatCrowd) {
  // An instrument that records before the test starts: nine tenths of the points lie in a thousandth of the range.
  std::vector<double> x = evenly(0, 1.5e-4, 900);
  for (const double at : evenly(1.6e-4, 0.15, 100)) x.push_back(at);
  const ReducedCurve reduced = expect_sense(curve_of(x, j_curve), 0.02);
  EXPECT_LE(reduced.max_deviation, 0.02 * j_curve(0.15));
}

TEST(HardCurves, NeighboursThatDifferInTheLastDigits) {
  std::vector<double> x;
  for (const double at : evenly(0.001, 0.15, 200)) {
    x.push_back(at);
    x.push_back(std::nextafter(at, 1));
    x.push_back(at * (1 + 1e-14));
  }
  EXPECT_LE(expect_sense(curve_of(x, j_curve), 0.02).relative_rms, 0.01);
}

TEST(HardCurves, RepeatedPointsCountNothingMore) {
  const MeasuredCurve curve = curve_of(evenly(0, 0.15, 120), j_curve);
  MeasuredCurve repeated;
  for (const auto& point : curve.points)
    for (int k = 0; k < 50; ++k) repeated.points.push_back(point);
  const ReducedCurve once = reduce(curve, {}), often = expect_sense(repeated, 0.02);
  ASSERT_EQ(once.control_points.size(), often.control_points.size());
  for (std::size_t i = 0; i < once.control_points.size(); ++i)
    EXPECT_NEAR((once.control_points[i] - often.control_points[i]).norm(), 0, 1e-6);
}

TEST(HardCurves, DirectionsInAnyOrder) {
  MeasuredCurve curve;
  curve.task = Task::stiffness;
  for (const double at : evenly(0, std::numbers::pi * 179 / 180, 180))
    curve.points.emplace_back(at, 2 + std::cos(2 * at));
  const ReducedCurve ordered = expect_sense(curve, 0.05);
  std::mt19937 random(7);
  std::shuffle(curve.points.begin(), curve.points.end(), random);
  const ReducedCurve shuffled = expect_sense(curve, 0.05);
  ASSERT_EQ(ordered.control_points.size(), shuffled.control_points.size());
  for (std::size_t i = 0; i < ordered.control_points.size(); ++i)
    EXPECT_NEAR((ordered.control_points[i] - shuffled.control_points[i]).norm(), 0, 1e-9);
}

TEST(HardCurves, ASensorThatDropsOut) {
  MeasuredCurve curve = curve_of(evenly(0, 0.15, 400), j_curve);
  curve.points[100].y() = std::numeric_limits<double>::infinity();
  curve.points[200].y() = std::numeric_limits<double>::quiet_NaN();
  curve.points[300].y() = 0;
  const ReducedCurve reduced = expect_sense(curve, 0.05);
  EXPECT_EQ(reduced.set_aside.total(), 2U);
  EXPECT_LE(reduced.relative_rms, 0.1);
  EXPECT_NEAR(reduced.max_at, curve.points[300].x(), 1e-12) << "the point that is off is told";
}

TEST(HardCurves, AMillionPoints) {
  MeasuredCurve curve;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.005);
  for (const double at : evenly(0, 0.15, 1'000'000)) curve.points.emplace_back(at, j_curve(at) + noise(random));
  const ReducedCurve reduced = expect_sense(curve, 0.05);
  // The remaining deviation is the noise.
  EXPECT_NEAR(reduced.relative_rms, reduced.noise, 0.2 * reduced.noise);
}

TEST(HardCurves, OneStrainIsNoCurve) {
  MeasuredCurve curve;
  for (int i = 0; i < 100; ++i) curve.points.emplace_back(0.05, 0.01 * i);
  try {
    reduce(curve, {});
    FAIL() << "was reduced";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "design.invalid_measurement");
  }
}

}  // namespace
}  // namespace supple::design
