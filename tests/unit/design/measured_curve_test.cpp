#include "supple/design/measured_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "supple/base/error.h"
#include "support/expect_error.h"

namespace supple::design {
namespace {

MeasuredCurve sampled(double lower, double upper, int count, double (*f)(double)) {
  MeasuredCurve curve;
  for (int i = 0; i < count; ++i) {
    const double x = lower + (upper - lower) * i / (count - 1);
    curve.points.emplace_back(x, f(x));
  }
  return curve;
}

/// Soft, then stiff: the response of a shoe's sole.
double j_curve(double x) { return 0.2 * x + 0.02 * (std::exp(18 * x) - 1); }
double plateau(double x) { return std::tanh(25 * x) + 40 * std::pow(std::max(0.0, x - 0.2), 2); }

numerics::Interpolant curve_of(const ReducedCurve& reduced, std::optional<double> period = std::nullopt) {
  std::vector<double> x, y;
  for (const auto& p : reduced.control_points) {
    x.push_back(p.x());
    y.push_back(p.y());
  }
  return {x, y, reduced.interpolation, period};
}

TEST(MeasuredUnits, TurnNumbersIntoTheProfilesOwn) {
  const auto x = [](const char* unit) { return conversion_of_x(Task::stress_strain, unit, {50.0, 20.0}); };
  const auto y = [](const char* unit) { return conversion_of_y(Task::stress_strain, unit, {50.0, 20.0}); };
  EXPECT_DOUBLE_EQ(x("%").factor, 0.01);
  EXPECT_DOUBLE_EQ(x("mm/mm").factor, 1);
  EXPECT_DOUBLE_EQ(x("mm").factor, 0.02);
  EXPECT_DOUBLE_EQ(x("in").factor, 25.4 / 50);
  EXPECT_DOUBLE_EQ(x("stretch").offset, -1);
  EXPECT_DOUBLE_EQ(y("kPa").factor, 1e-3);
  EXPECT_DOUBLE_EQ(y("N/mm\xC2\xB2").factor, 1);
  EXPECT_DOUBLE_EQ(y("N").factor, 0.05);
  EXPECT_DOUBLE_EQ(y("kgf").factor, 9.80665 / 20);
  EXPECT_NEAR(y("psi").factor, 0.00689476, 1e-8);
  EXPECT_DOUBLE_EQ(conversion_of_x(Task::poisson, "\xC2\xB0", {}).factor, std::numbers::pi / 180);
  EXPECT_DOUBLE_EQ(conversion_of_y(Task::poisson, "%", {}).factor, 0.01);
  EXPECT_EQ(canonical_unit("N/mm2"), "N/mm^2");
  EXPECT_EQ(canonical_unit("furlong"), "");
  for (const auto& [written, known] : {std::pair("KN", "kN"),
                                       {"kpa", "kPa"},
                                       {"MPA", "MPa"},
                                       {"lbs", "lbf"},
                                       {"Lbf", "lbf"},
                                       {"MM", "mm"},
                                       {"N / mm^2", "N/mm^2"},
                                       {"kgf/cm\xC2\xB2", "kgf/cm^2"},
                                       {"PSI", "psi"},
                                       {"\xC2\xB5m/m", "microstrain"},
                                       {"MN/m\xC2\xB2", "MPa"},
                                       {"[kPa]", "kPa"}})
    EXPECT_EQ(canonical_unit(written), known) << written;
  for (const char* written : {"mPa", "MN", "mn", "M", "s", "sec", ""})
    EXPECT_EQ(canonical_unit(written), "") << written;
}

TEST(MeasuredUnits, AreRefusedWithWhatTheyNeed) {
  const auto where = [](const auto& convert) -> std::string {
    const auto read = [&] {
      convert();
      return "nothing thrown";
    };
    return testing::text_or_places(read, "design.invalid_measurement");
  };
  EXPECT_EQ(where([] { conversion_of_x(Task::stress_strain, "mm", {}); }), "specimen/gauge_length");
  EXPECT_EQ(where([] { conversion_of_y(Task::stress_strain, "N", {50.0, 0.0}); }), "specimen/area");
  EXPECT_EQ(where([] { conversion_of_x(Task::stress_strain, "MPa", {}); }), "units/x");
  EXPECT_EQ(where([] { conversion_of_x(Task::stiffness, "%", {}); }), "units/x");
  EXPECT_EQ(where([] { conversion_of_y(Task::stiffness, "N", {1.0, 1.0}); }), "units/y");
  EXPECT_EQ(where([] { conversion_of_y(Task::stress_strain, "", {}); }), "units/y");
}

TEST(Reduction, RefusesWhatNoTargetCanHold) {
  const auto answer = [](double y) {
    return testing::text_or_places(
        [&] {
          MeasuredCurve curve;
          curve.points = {{0, 0}, {0.1, 1}, {0.2, y}};
          reduce(curve, ReductionOptions{});
          return "taken";
        },
        "design.invalid_measurement");
  };
  EXPECT_EQ(answer(9e5), "taken");
  for (const double y : {1.1e6, -1.1e6, 1e308, -1e308}) EXPECT_EQ(answer(y), "points") << y;
}

TEST(Reduction, FollowsSmoothCurvesWithFewPoints) {
  for (const auto f : {j_curve, plateau}) {
    const auto reduced = reduce(sampled(0, 0.3, 500, f), ReductionOptions{});
    EXPECT_LE(reduced.relative_rms, 0.005);
    EXPECT_LE(reduced.control_points.size(), 8U);
    EXPECT_TRUE(reduced.through_origin);
    EXPECT_EQ(reduced.points.size(), 500U);
    const auto curve = curve_of(reduced);
    double worst = 0;
    for (const auto& p : reduced.points) worst = std::max(worst, std::abs(curve(p.x()) - p.y()));
    EXPECT_NEAR(reduced.max_deviation, worst, 1e-12);
    EXPECT_NEAR(std::abs(curve(reduced.max_at) - f(reduced.max_at)), worst, 1e-12);
  }
}

TEST(Reduction, TakesMorePointsForMoreAccuracy) {
  const auto measured = sampled(0, 0.3, 500, plateau);
  ReductionOptions fine;
  fine.max_control_points = 40;
  fine.tolerance = 1e-4;
  const auto coarse = reduce(measured, ReductionOptions{});
  const auto closest = reduce(measured, fine);
  EXPECT_LE(closest.relative_rms, 1e-4);
  EXPECT_GT(closest.control_points.size(), coarse.control_points.size());
  EXPECT_LE(closest.control_points.size(), 40U);
}

TEST(Reduction, KeepsToTheNumberOfPointsAsked) {
  for (const auto interpolation :
       {numerics::Interpolation::cubic, numerics::Interpolation::monotone, numerics::Interpolation::linear}) {
    ReductionOptions options;
    options.interpolation = interpolation;
    options.tolerance = 1e-9;
    double before = INFINITY;
    for (const int count : {3, 6, 12}) {
      options.max_control_points = count;
      const auto reduced = reduce(sampled(0, 0.3, 300, plateau), options);
      EXPECT_LE(reduced.control_points.size(), static_cast<std::size_t>(count));
      EXPECT_LT(reduced.relative_rms, before);
      before = reduced.relative_rms;
    }
    // The monotone curve has smaller slopes than the data where they bend.
    EXPECT_LT(before, interpolation == numerics::Interpolation::monotone ? 0.02 : 0.01)
        << numerics::to_string(interpolation);
  }
}

TEST(Reduction, DoesNotFollowNoise) {
  auto measured = sampled(0, 0.3, 2000, j_curve);
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 0.2);
  for (auto& p : measured.points) p.y() += noise(random);
  const auto reduced = reduce(measured, ReductionOptions{});
  EXPECT_LE(reduced.control_points.size(), 9U);
  double scale = 0, off = 0;
  const auto curve = curve_of(reduced);
  for (const auto& p : reduced.points) {
    scale += std::pow(j_curve(p.x()), 2);
    off += std::pow(curve(p.x()) - j_curve(p.x()), 2);
  }
  EXPECT_LT(std::sqrt(off / scale), 0.02) << "of the curve without noise";
  EXPECT_NEAR(reduced.noise * std::sqrt(scale / 2000), 0.2, 0.03) << "relative to points that scatter, too";
}

TEST(Reduction, HasAPointAtTheOriginBetweenTheEndsOfACurveThatGoesBothWays) {
  const auto points = [](double lower, double upper) {
    return reduce(sampled(lower, upper, 200, [](double x) { return 3 * x; }), ReductionOptions{}).control_points;
  };
  // The fraction of the range on either side of zero decides, for any unit.
  for (const double unit : {0.01, 100.0}) {
    EXPECT_EQ(points(-0.1 * unit, unit).size(), 3U) << unit;
    EXPECT_EQ(points(-unit, 0.1 * unit).size(), 3U) << unit;
    EXPECT_EQ(points(-0.03 * unit, unit).size(), 2U) << unit;
    EXPECT_EQ(points(-unit, 0.03 * unit).size(), 2U) << unit;
  }
}

TEST(Reduction, PassesThroughTheOriginAndSaysWhatWasThere) {
  auto measured = sampled(0.002, 0.3, 200, j_curve);
  for (auto& p : measured.points) p.y() += 0.05;
  const auto reduced = reduce(measured, ReductionOptions{});
  ASSERT_TRUE(reduced.through_origin);
  EXPECT_EQ(reduced.control_points.front(), Eigen::Vector2d(0, 0));
  EXPECT_NEAR(reduced.offset, 0.05, 0.01);

  ReductionOptions off;
  off.origin = Switch::off;
  EXPECT_NE(reduce(measured, off).control_points.front().y(), 0);
  EXPECT_FALSE(reduce(sampled(0.1, 0.3, 200, j_curve), ReductionOptions{}).through_origin);

  const auto both = reduce(sampled(-0.1, 0.2, 200, [](double x) { return 3 * x + x * x; }), ReductionOptions{});
  const auto& points = both.control_points;
  EXPECT_TRUE(std::any_of(points.begin(), points.end(), [](const auto& p) { return p == Eigen::Vector2d(0, 0); }));
}

TEST(Reduction, TakesTheFirstLoadingOfACycle) {
  MeasuredCurve cycle = sampled(0, 0.3, 300, j_curve);
  const auto unloading = sampled(0.3, 0, 300, [](double x) { return 0.5 * j_curve(x); });
  cycle.points.insert(cycle.points.end(), unloading.points.begin(), unloading.points.end());
  const auto reduced = reduce(cycle, ReductionOptions{});
  EXPECT_TRUE(reduced.first_loading);
  EXPECT_EQ(reduced.set_aside.total(), 300U);
  EXPECT_LE(reduced.relative_rms, 0.005);
  EXPECT_NEAR(curve_of(reduced)(0.25), j_curve(0.25), 0.01 * j_curve(0.25));

  ReductionOptions all;
  all.loading = Switch::off;
  const auto mean = reduce(cycle, all);
  EXPECT_EQ(mean.set_aside.total(), 0U);
  EXPECT_NEAR(curve_of(mean)(0.25), 0.75 * j_curve(0.25), 0.02 * j_curve(0.25));
}

TEST(Reduction, FollowsTheVirginCurveOfGrowingCycles) {
  // As in filled rubber, each loading is softer up to the previous maximum, and follows the virgin curve beyond.
  for (const double sign : {1.0, -1.0}) {
    MeasuredCurve cycles;
    double reached = 0;
    for (const double peak : {0.1, 0.2, 0.3}) {
      for (int i = 0; i <= 100; ++i) {
        const double x = peak * i / 100;
        cycles.points.emplace_back(sign * x, sign * (x < reached ? 0.3 : 1) * j_curve(x));
      }
      for (int i = 100; i >= 0; --i)
        cycles.points.emplace_back(sign * peak * i / 100, sign * 0.2 * j_curve(peak * i / 100));
      reached = peak;
    }
    const auto reduced = reduce(cycles, ReductionOptions{});
    EXPECT_TRUE(reduced.first_loading);
    EXPECT_GT(reduced.set_aside.not_first_loading, 300U);
    for (const double x : {0.05, 0.1, 0.15, 0.19, 0.25, 0.29})
      EXPECT_NEAR(sign * curve_of(reduced)(sign * x), j_curve(x), 0.02 * j_curve(0.3)) << x;
  }
}

TEST(Reduction, CyclesThatShakeAndBeginWithSlackGiveTheirFirstLoading) {
  MeasuredCurve cycle;
  for (const double x : {0.03, 0.02, 0.01}) cycle.points.emplace_back(x, 0);
  for (int i = 0; i <= 300; ++i) cycle.points.emplace_back(0.001 * i + (i % 2 == 0 ? 0.002 : 0), j_curve(0.001 * i));
  for (int i = 300; i >= 0; --i) cycle.points.emplace_back(0.001 * i, 0.5 * j_curve(0.001 * i));
  const auto reduced = reduce(cycle, ReductionOptions{});
  EXPECT_TRUE(reduced.first_loading);
  EXPECT_NEAR(curve_of(reduced)(0.25), j_curve(0.25), 0.03 * j_curve(0.25));
  EXPECT_NEAR(static_cast<double>(reduced.set_aside.not_first_loading), 304, 3);
}

TEST(Reduction, LeavesOutWhatFollowsABreak) {
  MeasuredCurve test = sampled(0, 0.3, 300, j_curve);
  for (int i = 1; i <= 40; ++i) test.points.emplace_back(0.3 + 0.001 * i, i == 1 ? 0.5 * j_curve(0.3) : 0.01);
  const auto reduced = reduce(test, ReductionOptions{});
  EXPECT_EQ(reduced.set_aside.after_rupture, 40U);
  EXPECT_NEAR(reduced.rupture_at.value(), 0.3, 1e-12);
  EXPECT_LE(reduced.relative_rms, 0.005);
  ReductionOptions off;
  off.rupture = Switch::off;
  EXPECT_EQ(reduce(test, off).set_aside.total(), 0U);
  // A cell wall that snaps through, and a stress that decreases slowly, are no ruptures.
  EXPECT_EQ(reduce(sampled(0, 0.15, 400, [](double x) { return x < 0.07 ? 12 * x : 4 * x; }), {}).set_aside.total(),
            0U);
  EXPECT_EQ(reduce(sampled(0, 1, 200, [](double x) { return x * std::exp(-8 * x); }), {}).set_aside.total(), 0U);
}

TEST(Reduction, TakesCompressionAsItTakesTension) {
  MeasuredCurve test = sampled(0, -0.3, 300, [](double x) { return -j_curve(-x); });
  const auto loaded = reduce(test, ReductionOptions{});
  EXPECT_FALSE(loaded.first_loading);
  EXPECT_EQ(loaded.points.size(), 300U);
  EXPECT_LE(loaded.relative_rms, 0.005);
  const auto unloading = sampled(-0.3, 0, 300, [](double x) { return -0.5 * j_curve(-x); });
  test.points.insert(test.points.end(), unloading.points.begin(), unloading.points.end());
  const auto cycle = reduce(test, ReductionOptions{});
  EXPECT_TRUE(cycle.first_loading);
  EXPECT_EQ(cycle.set_aside.total(), 300U);
  EXPECT_NEAR(curve_of(cycle)(-0.25), -j_curve(0.25), 0.01 * j_curve(0.25));
  for (const auto& [from, to] : {std::pair(-0.2, 0.1), std::pair(0.1, -0.2), std::pair(0.2, -0.1)})
    EXPECT_FALSE(reduce(sampled(from, to, 200, [](double x) { return x; }), ReductionOptions{}).first_loading);
}

TEST(Reduction, AStrainThatShakesIsNoCycle) {
  auto measured = sampled(0, 0.3, 300, j_curve);
  for (std::size_t i = 0; i < measured.points.size(); i += 2) measured.points[i].x() += 0.003;
  EXPECT_FALSE(reduce(measured, ReductionOptions{}).first_loading);
}

TEST(Reduction, TakesDirectionsModuloHalfATurn) {
  MeasuredCurve measured = sampled(0, 2 * std::numbers::pi, 361, [](double x) { return 2 + std::cos(2 * x); });
  measured.task = Task::stiffness;
  const auto reduced = reduce(measured, ReductionOptions{});
  const auto& points = reduced.control_points;
  EXPECT_LE(reduced.relative_rms, 0.005);
  EXPECT_LT(points.back().x() - points.front().x(), std::numbers::pi);
  EXPECT_FALSE(reduced.through_origin);
  const auto curve = curve_of(reduced, std::numbers::pi);
  for (const double x : {0.1, 1.0, 2.0, 3.1}) EXPECT_NEAR(curve(x), 2 + std::cos(2 * x), 0.03);
}

TEST(Reduction, CountsWithinTheRangeAskedFor) {
  ReductionOptions options;
  options.lower = 0;
  options.upper = 0.1;
  const auto reduced = reduce(sampled(-0.1, 0.3, 401, j_curve), options);
  EXPECT_EQ(reduced.points.size(), 101U);
  EXPECT_EQ(reduced.set_aside.total(), 300U);
  EXPECT_NEAR(reduced.control_points.back().x(), 0.1, 1e-12);
}

TEST(Reduction, SetsAsideWhatIsNotFinite) {
  auto measured = sampled(0, 0.3, 100, j_curve);
  measured.points[5].y() = NAN;
  measured.points[7].x() = INFINITY;
  const auto reduced = reduce(measured, ReductionOptions{});
  EXPECT_EQ(reduced.set_aside.total(), 2U);
  EXPECT_LE(reduced.relative_rms, 0.005);
}

TEST(Reduction, OfTwoPointsIsALine) {
  MeasuredCurve curve;
  curve.points = {{0.1, 1}, {0.3, 2}};
  const auto reduced = reduce(curve, ReductionOptions{});
  ASSERT_EQ(reduced.control_points.size(), 2U);
  EXPECT_NEAR(reduced.relative_rms, 0, 1e-8);
}

TEST(Reduction, OfZerosIsZero) {
  const auto reduced = reduce(sampled(0, 1, 50, [](double) { return 0.0; }), ReductionOptions{});
  EXPECT_EQ(reduced.relative_rms, 0);
  for (const auto& p : reduced.control_points) EXPECT_EQ(p.y(), 0);
}

TEST(Reduction, RefusesTooFewPoints) {
  MeasuredCurve curve;
  EXPECT_THROW(reduce(curve, ReductionOptions{}), Error);
  curve.points = {{0.1, 1}, {0.1, 2}};
  EXPECT_THROW(reduce(curve, ReductionOptions{}), Error);
  ReductionOptions options;
  options.max_control_points = 65;
  EXPECT_THROW(reduce(sampled(0, 1, 50, j_curve), options), Error);
}

TEST(Reduction, BillsItsEffects) {
  CostLedger ledger;
  Execution execution;
  execution.cost = &ledger;
  reduce(sampled(0, 0.3, 100, j_curve), ReductionOptions{}, execution);
  ASSERT_EQ(ledger.effects().size(), 3U);
  EXPECT_EQ(ledger.effects()[0].name, "loading");
  EXPECT_FALSE(ledger.effects()[0].ran);
  EXPECT_EQ(ledger.effects()[1].name, "rupture");
  EXPECT_FALSE(ledger.effects()[1].ran);
  EXPECT_EQ(ledger.effects()[2].name, "origin");
  EXPECT_TRUE(ledger.effects()[2].ran);
}

}  // namespace
}  // namespace supple::design
