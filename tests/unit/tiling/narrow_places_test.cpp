#include "narrow_places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace supple::tiling {
namespace {

constexpr double usual = 1;

Polygon turned(Polygon polygon, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  for (auto& p : polygon) p = Eigen::Vector2d(c * p.x() - s * p.y(), s * p.x() + c * p.y());
  return polygon;
}

Polygon clockwise(Polygon polygon) {
  std::reverse(polygon.begin(), polygon.end());
  return polygon;
}

/// Two plates that are connected by a strip of the given width and length.
Polygon dumbbell(double width, double length) {
  const double w = width / 2, l = length / 2;
  return {{-l - 4, -2}, {-l, -2}, {-l, -w}, {l, -w}, {l, -2}, {l + 4, -2},
          {l + 4, 2},   {l, 2},   {l, w},   {-l, w}, {-l, 2}, {-l - 4, 2}};
}

TEST(NarrowPlaces, AreMeasuredBetweenWiderOnes) {
  for (const double angle : {0.0, 0.1, 1.0, 2.5}) {
    for (const double length : {0.01, 1.0, 30.0}) {
      const NarrowPlaces found = narrow_places({turned(dumbbell(0.25, length), angle)}, 0.3, usual);
      ASSERT_FALSE(found.below.empty()) << angle << ", " << length;
      for (const NarrowPlace& place : found.below) EXPECT_NEAR(place.width(), 0.25, 1e-12);
      EXPECT_FALSE(found.narrowest_other.has_value());
      const NarrowPlaces wide = narrow_places({turned(dumbbell(0.25, length), angle)}, 0.2, usual);
      EXPECT_TRUE(wide.below.empty());
      EXPECT_NEAR(wide.narrowest_other.value_or(0), 0.25, 1e-12);
    }
  }
}

TEST(NarrowPlaces, AreFoundHoweverWideTheyAre) {
  EXPECT_NEAR(narrow_places({dumbbell(0.25, 3)}, 0, 1e-3).narrowest_other.value_or(0), 0.25, 1e-12);
  EXPECT_NEAR(narrow_places({dumbbell(0.25, 3)}, 0, 50).narrowest_other.value_or(0), 0.25, 1e-12);
}

TEST(NarrowPlaces, LieBetweenCornersThatAreAslant) {
  // The tips of this hourglass are offset. Their distance is its width.
  const Polygon hourglass = {{-5, -5}, {5, -5}, {0.1, -0.05}, {5, 5}, {-5, 5}, {-0.1, 0.05}};
  const NarrowPlaces found = narrow_places({hourglass}, 1, usual);
  ASSERT_EQ(found.below.size(), 1U);
  EXPECT_NEAR(found.below[0].width(), std::hypot(0.2, 0.1), 1e-12);
  EXPECT_NEAR(found.below[0].middle().norm(), 0, 1e-12);
}

TEST(NarrowPlaces, LieBetweenHoles) {
  const auto square = [](double x, double y, double half) {
    return Polygon{{x - half, y - half}, {x + half, y - half}, {x + half, y + half}, {x - half, y + half}};
  };
  const SolidFace plate = {square(0, 0, 5), clockwise(square(-1.2, 0, 1)), clockwise(square(1.2, 0.3, 1)),
                           clockwise(square(0, -4, 0.4))};
  const NarrowPlaces found = narrow_places(plate, 0.5, usual);
  ASSERT_FALSE(found.below.empty());
  for (const NarrowPlace& place : found.below) EXPECT_NEAR(place.width(), 0.4, 1e-12) << "the wall between two holes";
  EXPECT_NEAR(found.narrowest_other.value_or(0), 0.6, 1e-12) << "the wall between a hole and the outline";
}

TEST(NarrowPlaces, AreNeitherAcuteCornersNorDeadEnds) {
  // On a plate there are a spike and a stub with parallel sides, both narrower than the limit, and a tapered stub.
  const Polygon plate = {{0, 0},   {10, 0}, {10, 4},  {7.05, 4},   {7, 6},      {6.95, 4}, {4.2, 4}, {4.2, 4.5},
                         {4, 4.5}, {4, 4},  {2.2, 4}, {2.15, 4.5}, {2.05, 4.5}, {2, 4},    {0, 4}};
  for (const double angle : {0.0, 0.4, 1.1}) {
    const NarrowPlaces found = narrow_places({turned(plate, angle)}, 0.5, usual);
    EXPECT_TRUE(found.below.empty()) << angle;
    EXPECT_NEAR(found.narrowest_other.value_or(0), 4, 1e-9) << "the plate, which is wider where a stub stands on it";
  }
}

TEST(NarrowPlaces, AreInNoConvexSolidAndAllAroundARing) {
  Polygon circle, bore;
  constexpr int corners = 200;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * k / corners;
    circle.emplace_back(3 * std::cos(angle), 3 * std::sin(angle));
    bore.emplace_back(2.5 * std::cos(angle), 2.5 * std::sin(angle));
  }
  EXPECT_TRUE(narrow_places({circle}, 10, usual).below.empty());
  // A ring has the same width everywhere, except that polygons replace its circles.
  const NarrowPlaces ring = narrow_places({circle, clockwise(bore)}, 0.6, usual);
  EXPECT_FALSE(ring.below.empty());
  for (const NarrowPlace& place : ring.below) EXPECT_NEAR(place.width(), 0.5, 1e-3);
}

}  // namespace
}  // namespace supple::tiling
