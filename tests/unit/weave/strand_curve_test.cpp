#include "supple/weave/strand_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "supple/base/random.h"
#include "supple/weave/weave_error.h"
#include "support/expect_error.h"

namespace supple::weave {
namespace {

using Points = std::vector<Eigen::Vector2d>;
using std::numbers::pi;

Points on_circle(int count, double radius, double sweep = 2 * pi) {
  Points points;
  points.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double angle = sweep * i / count;
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return points;
}

/// Points of very uneven spacing on a wavy loop.
Points uneven_loop() {
  Points points;
  points.reserve(14);
  RandomStream random("uneven_loop", 3);
  double angle = 0;
  for (int i = 0; i < 14; ++i) {
    angle += (i % 2 == 0 ? 0.1 : 0.7) * random.uniform(0.8, 1.1);
    const double radius = 10 + 2 * std::cos(3 * angle);
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return points;
}

double speed_error(const StrandCurve& curve) {
  double worst = 0;
  for (int i = 0; i < 2000; ++i)
    worst = std::max(worst, std::abs(curve.at(curve.length() * i / 2000).first.norm() - 1));
  return worst;
}

TEST(StrandCurve, GoesThroughItsPointsAtTheCoordinatesItNames) {
  for (const Ends ends : {Ends::open, Ends::closed}) {
    const Points points = uneven_loop();
    const StrandCurve curve(points, ends);
    ASSERT_EQ(curve.point_coordinates().size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_LT((curve.at(curve.point_coordinates()[i]).position - points[i]).norm(), 1e-12) << i;
  }
}

TEST(StrandCurve, IsParametrizedByArcLengthHoweverUnevenItsPointsAre) {
  EXPECT_LT(speed_error(StrandCurve(uneven_loop(), Ends::closed)), 1e-4);
  EXPECT_LT(speed_error(StrandCurve(uneven_loop(), Ends::open)), 3e-4);
  EXPECT_LT(speed_error(StrandCurve(on_circle(8, 5.5), Ends::closed)), 1e-5);
}

TEST(StrandCurve, ApproachesACircleWithTheFourthPowerOfThePointsDistance) {
  double last = 0;
  for (const int count : {8, 16, 32}) {
    const StrandCurve curve(on_circle(count, 8), Ends::closed);
    const double error = std::abs(curve.length() - 2 * pi * 8);
    if (last > 0) {
      EXPECT_GT(std::log2(last / error), 3.7) << count;
    }
    last = error;
  }
  EXPECT_LT(last, 2e-4);
}

TEST(StrandCurve, HasContinuousSecondDerivativesEverywhereAndNoSeam) {
  for (const auto& curve :
       {StrandCurve(uneven_loop(), Ends::closed), StrandCurve({{0, 0}, {1, 1}, {3, -1}}, Ends::periodic, {4, 0.5})}) {
    for (const double knot : curve.knots()) {
      const double h = 1e-7;
      const auto before = curve.at(knot - h);
      const auto after = curve.at(knot + h);
      EXPECT_LT((after.position - before.position).norm(), 3 * h);
      EXPECT_LT((after.first - before.first).norm(), 20 * h);
      // The third derivative is bounded, so that the remaining difference shrinks with h.
      EXPECT_LT((after.second - before.second).norm(), 300 * h);
    }
  }
}

TEST(StrandCurve, HasTheDerivativesOfItsPositions) {
  const StrandCurve curve(uneven_loop(), Ends::closed);
  RandomStream random("curve_derivatives", 1);
  const double h = 1e-4;
  for (int trial = 0; trial < 50; ++trial) {
    const double s = random.uniform(-1, 2) * curve.length();
    const auto m = curve.at(s - h);
    const auto p = curve.at(s + h);
    const auto at = curve.at(s);
    EXPECT_LT(((p.position - m.position) / (2 * h) - at.first).norm(), 1e-7);
    EXPECT_LT(((p.first - m.first) / (2 * h) - at.second).norm(), 2e-4);
    EXPECT_LT(((p.second - m.second) / (2 * h) - at.third).norm(), 0.5 * (1 + at.third.norm()));
  }
}

/// Points of a comb whose teeth are as high as their number: its spline has hairpins at the tips, and open ends that
/// swing out.
Points points_of_comb(int teeth, bool upright) {
  Points points;
  points.reserve(static_cast<std::size_t>(teeth));
  for (int i = 0; i < teeth; ++i) {
    const double along = i;
    const double across = i % 2 == 1 ? teeth : 0;
    points.emplace_back(upright ? across : along, upright ? along : across);
  }
  return points;
}

TEST(StrandCurve, HasPiecesThatTurnByLittleEverywhere) {
  const StrandCurve curve(points_of_comb(60, false), Ends::open);
  const auto& knots = curve.knots();
  double most = 0;
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const Eigen::Vector2d begin = curve.at(knots[i]).first;
    for (const double share : {0.5, 1 - 1e-9}) {
      const Eigen::Vector2d there = curve.at(knots[i] + share * (knots[i + 1] - knots[i])).first;
      most = std::max(most, std::acos(std::clamp(begin.normalized().dot(there.normalized()), -1.0, 1.0)));
    }
  }
  EXPECT_LT(most, 0.13);
}

TEST(StrandCurve, GoesStraightOnBeyondItsOpenEnds) {
  const StrandCurve curve({{0, 0}, {2, 1}, {4, -1}, {7, 0}}, Ends::open);
  const double whole = curve.length();
  for (const auto& [end, beyond] : {std::pair(0.0, -1.5), std::pair(whole, whole + 1.5)}) {
    const auto at = curve.at(end);
    const auto there = curve.at(beyond);
    EXPECT_LT((there.position - (at.position + (beyond - end) * at.first)).norm(), 1e-12);
    EXPECT_EQ(there.first, at.first);
    EXPECT_EQ(there.second, Eigen::Vector2d(0, 0));
    EXPECT_EQ(there.third, Eigen::Vector2d(0, 0));
  }
}

TEST(StrandCurve, RepeatsWithItsTranslation) {
  const StrandCurve wave({{0, 0}, {1, 1}, {3, -1}}, Ends::periodic, {4, 0.5});
  const auto at = wave.at(0.7);
  const auto later = wave.at(0.7 + 2 * wave.length());
  EXPECT_LT((later.position - at.position - Eigen::Vector2d(8, 1)).norm(), 1e-12);
  EXPECT_LT((later.second - at.second).norm(), 1e-12);
}

TEST(StrandCurve, OfPointsOnALineIsStraight) {
  const StrandCurve line({{1, 1}, {2, 2}, {5, 5}}, Ends::open);
  EXPECT_TRUE(line.straight());
  EXPECT_DOUBLE_EQ(line.length(), std::sqrt(32));
  EXPECT_NEAR(line.point_coordinates()[1], std::sqrt(2), 1e-15);
  EXPECT_NEAR((line.at(1).first - Eigen::Vector2d(1, 1).normalized()).norm(), 0, 1e-15);
  EXPECT_FALSE(StrandCurve({{0, 0}, {2, 0}, {1, 0.1}}, Ends::open).straight());
}

TEST(StrandCurve, FollowsAnArcUpToItsOpenEnds) {
  const Points arc = on_circle(9, 5.5, pi / 2 * 9 / 8);
  const StrandCurve curve(arc, Ends::open);
  EXPECT_NEAR(curve.length(), 5.5 * pi / 2, 5e-5);
  for (int i = 0; i <= 100; ++i) {
    const auto p = curve.at(curve.length() * i / 100);
    EXPECT_NEAR(p.second.norm(), 1 / 5.5, 6e-3) << i << ": no end condition flattens an end";
  }
}

TEST(StrandCurve, RefusesWhatIsNoCurve) {
  const auto error = ::supple::testing::expect_error<WeaveError>("weave.invalid_strand", [] {
    StrandCurve({{0, 0}, {1, 0}, {1, 0}}, Ends::open);
  });
  EXPECT_EQ(::supple::testing::places(error), std::vector<std::string>{"points/2"});
  ::supple::testing::expect_error<WeaveError>("weave.invalid_strand", [] { StrandCurve({{0, 0}}, Ends::open); });
  ::supple::testing::expect_error<WeaveError>("weave.invalid_strand", [] {
    StrandCurve({{0, 0}, {1, 1}}, Ends::closed);
  });
  ::supple::testing::expect_error<WeaveError>("weave.invalid_strand", [] {
    StrandCurve({{0, 0}, {1, 1}}, Ends::periodic);
  });
  ::supple::testing::expect_error<WeaveError>("weave.invalid_strand", [] {
    StrandCurve({{0, 0}, {NAN, 1}}, Ends::open);
  });
}

TEST(Intersections, FindsWhereALineCutsACircleAndTwoCirclesCutEachOther) {
  const StrandCurve circle(on_circle(64, 5.5), Ends::closed);
  const StrandCurve line({{-10, 3}, {10, 3}}, Ends::open);
  const auto cuts = intersections(line, circle, {0, 0});
  ASSERT_EQ(cuts.size(), 2U);
  const double x = std::sqrt(5.5 * 5.5 - 9);
  EXPECT_NEAR(cuts[0].first, 10 - x, 1e-5);
  EXPECT_NEAR(cuts[1].first, 10 + x, 1e-5);
  EXPECT_NEAR(cuts[0].angle, std::acos(3 / 5.5), 1e-4);
  // Two circles with centres 10 apart intersect at x = 5, y = +-sqrt(5.5^2 - 25).
  const auto pair = intersections(circle, circle, {10, 0});
  ASSERT_EQ(pair.size(), 2U);
  for (const auto& cut : pair) EXPECT_NEAR(circle.at(cut.first).position[0], 5, 1e-5);
}

// Straight teeth would cross once each. Curved ones do so too, some within a few hundredths of a millimetre in a
// hairpin.
TEST(Intersections, OfTwoCombsAreAllFound) {
  constexpr int teeth = 60;
  const StrandCurve lying(points_of_comb(teeth, false), Ends::open);
  const StrandCurve upright(points_of_comb(teeth, true), Ends::open);
  const auto found = intersections(lying, upright, Eigen::Vector2d::Zero());
  EXPECT_EQ(found.size(), static_cast<std::size_t>((teeth - 1) * (teeth - 1)));
  for (const Intersection& at : found)
    EXPECT_LT((lying.at(at.first).position - upright.at(at.second).position).norm(), 1e-6);
}

TEST(Intersections, CountsEndsThatLieOnTheOtherStrandOnce) {
  const StrandCurve bottom({{-6, -6}, {6, -6}}, Ends::open);
  const StrandCurve right({{6, -6}, {6, 6}}, Ends::open);
  const auto corner = intersections(bottom, right, {0, 0});
  ASSERT_EQ(corner.size(), 1U);
  EXPECT_NEAR(corner[0].first, 12, 1e-9);
  EXPECT_NEAR(corner[0].second, 0, 1e-9);
  EXPECT_TRUE(intersections(bottom, right, {0, 0.1}).empty());
}

}  // namespace
}  // namespace supple::weave
