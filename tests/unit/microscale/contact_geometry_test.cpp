#include "contact_geometry.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "supple/base/random.h"
#include "supple/numerics/derivative_check.h"

namespace supple::microscale {
namespace {

using Eigen::Vector2d;

Vector2d random_vector(RandomStream& random) { return {random.normal(), random.normal()}; }

/// The distance of the origin from a segment, found by ternary search along the segment without distinguishing cases.
double searched_distance(const Vector2d& tail, const Vector2d& head) {
  double low = 0;
  double high = 1;
  for (int k = 0; k < 80; ++k) {
    const double a = low + (high - low) / 3;
    const double b = high - (high - low) / 3;
    if ((tail + a * (head - tail)).norm() < (tail + b * (head - tail)).norm())
      high = b;
    else
      low = a;
  }
  return (tail + low * (head - tail)).norm();
}

TEST(ViewSegment, SeesTheNearestPointInsideOrAtAnEnd) {
  RandomStream random("view_segment", 1);
  int seen[3] = {0, 0, 0};
  for (int trial = 0; trial < 1000; ++trial) {
    const Vector2d tail = random_vector(random);
    const Vector2d head = random_vector(random);
    const PointSegmentDistance view = point_segment_distance(tail, head);
    ++seen[static_cast<int>(view.nearest)];
    EXPECT_NEAR(std::sqrt(view.squared_distance), searched_distance(tail, head), 1e-7);
  }
  for (const int count : seen) EXPECT_GT(count, 100);
}

TEST(ViewSegment, TakesASegmentWithoutLengthForItsTail) {
  const PointSegmentDistance view = point_segment_distance(Vector2d(3, 4), Vector2d(3, 4));
  EXPECT_EQ(view.nearest, Nearest::tail);
  EXPECT_EQ(view.squared_distance, 25);
}

TEST(ViewSegment, IsZeroOnTheSegmentAndAtItsEnds) {
  EXPECT_EQ(point_segment_distance(Vector2d(0, 0), Vector2d(1, 2)).squared_distance, 0);
  EXPECT_EQ(point_segment_distance(Vector2d(1, 2), Vector2d(0, 0)).squared_distance, 0);
  EXPECT_EQ(point_segment_distance(Vector2d(-1, -2), Vector2d(1, 2)).squared_distance, 0);
  const PointSegmentDistance beyond = point_segment_distance(Vector2d(1, 0), Vector2d(2, 0));
  EXPECT_EQ(beyond.nearest, Nearest::tail);
  EXPECT_EQ(beyond.squared_distance, 1);
}

/// cos(d) as a function of point, tail and head. Both derivatives of the cosine are different from zero.
numerics::Evaluation cosine_of_distance(const Eigen::VectorXd& at) {
  const InsideDistance inside(at.segment<2>(2) - at.head<2>(), at.tail<2>() - at.head<2>());
  numerics::Evaluation evaluation;
  evaluation.value = std::cos(inside.distance);
  evaluation.gradient = -std::sin(inside.distance) * inside.gradient();
  evaluation.hessian = Eigen::MatrixXd(inside.hessian(-std::sin(inside.distance), -std::cos(inside.distance), false));
  return evaluation;
}

TEST(InsideDistance, HasTheDerivativesOfTheDistance) {
  RandomStream random("inside_distance", 1);
  for (int trial = 0; trial < 50; ++trial) {
    Eigen::VectorXd at(6);
    at.head<2>() = random_vector(random);
    const Vector2d along = random_vector(random).normalized();
    const Vector2d foot = at.head<2>() + random.uniform(-1, 1) * Vector2d(-along[1], along[0]);
    at.segment<2>(2) = foot - random.uniform(0.3, 2) * along;
    at.tail<2>() = foot + random.uniform(0.3, 2) * along;
    const InsideDistance inside(at.segment<2>(2) - at.head<2>(), at.tail<2>() - at.head<2>());
    if (inside.distance < 0.05) continue;
    numerics::DerivativeCheckOptions options;
    options.step = 1e-2 * inside.distance;
    const numerics::DerivativeCheck check = numerics::check_derivatives(
        [&](const Eigen::VectorXd& step, int) { return cosine_of_distance(at + step); }, 6, options);
    EXPECT_LT(check.gradient.error, 1e-8) << check.summary();
    EXPECT_LT(check.hessian.error, 1e-8) << check.summary();
  }
}

TEST(InsideDistance, GivesThePositiveSemidefinitePartOfAHessian) {
  RandomStream random("inside_distance", 2);
  for (int trial = 0; trial < 50; ++trial) {
    const double height = random.uniform(-1, 1);
    const InsideDistance inside(Vector2d(-random.uniform(0.1, 2), height), Vector2d(random.uniform(0.1, 2), height));
    const double first = random.normal();
    const double second = random.normal();
    const Eigen::SelfAdjointEigenSolver<InsideDistance::Matrix6> modes(inside.hessian(first, second, false));
    const InsideDistance::Matrix6 positive =
        modes.eigenvectors() * modes.eigenvalues().cwiseMax(0).asDiagonal() * modes.eigenvectors().transpose();
    EXPECT_LT((inside.hessian(first, second, true) - positive).norm(), 1e-12 * (1 + positive.norm()));
  }
}

TEST(LogBarrier, HasTheDerivativesOfItsFormula) {
  for (const double share : {0.01, 0.3, 0.5, 0.9}) {
    const double r = 0.02;
    const auto formula = [&](long double d) { return -(d - r) * (d - r) * std::log(d / r) / (2 * r); };
    const long double d = share * r;
    const long double h = 1e-4L * d;
    const LogBarrier barrier(static_cast<double>(d), r);
    EXPECT_NEAR(barrier.value, static_cast<double>(formula(d)), 1e-15);
    const auto slope = static_cast<double>((formula(d + h) - formula(d - h)) / (2 * h));
    const auto curvature = static_cast<double>((formula(d + h) - 2 * formula(d) + formula(d - h)) / (h * h));
    EXPECT_NEAR(barrier.first, slope, 1e-6 * std::abs(slope) + 1e-9);
    EXPECT_NEAR(barrier.second, curvature, 1e-5 * std::abs(curvature) + 1e-4);
  }
}

TEST(LogBarrier, VanishesWithTwoDerivativesAtItsRange) {
  const double r = 0.3;
  const LogBarrier near_range(r * (1 - 1e-6), r);
  EXPECT_NEAR(near_range.value, 0, 1e-17);
  EXPECT_NEAR(near_range.first, 0, 1e-11);
  EXPECT_NEAR(near_range.second, 0, 2e-5);
}

TEST(LogBarrier, GrowsBeyondBoundsTowardsZero) {
  double before = LogBarrier(0.1, 1).value;
  for (const double d : {1e-2, 1e-5, 1e-10, 1e-50, 1e-100, 1e-300}) {
    const LogBarrier barrier(d, 1);
    EXPECT_GT(barrier.value, before);
    EXPECT_LT(barrier.first, -0.4 / d);
    before = barrier.value;
  }
  EXPECT_EQ(LogBarrier(0, 1).value, std::numeric_limits<double>::infinity());
}

TEST(SafeShare, KeepsAShareOfTheDistanceOnRandomMotions) {
  RandomStream random("safe_share", 1);
  int cut = 0;
  int whole = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const Vector2d tail = random_vector(random);
    const Vector2d head = trial % 7 == 0 ? Vector2d(tail + 1e-9 * random_vector(random)) : random_vector(random);
    const double speed = std::pow(10, random.uniform(-3, 3));
    const Vector2d tail_change = speed * random_vector(random);
    const Vector2d head_change = trial % 5 == 0 ? tail_change : Vector2d(speed * random_vector(random));
    const double share = conservative_ccd_step(tail, head, tail_change, head_change, 0.2, 1);
    (share < 1 ? cut : whole)++;
    ASSERT_GT(share, 0);
    const double start = searched_distance(tail, head);
    for (int k = 0; k <= 25; ++k) {
      const double t = share * k / 25;
      ASSERT_GE(searched_distance(tail + t * tail_change, head + t * head_change), 0.2 * start * (1 - 1e-9) - 1e-12);
    }
  }
  EXPECT_GT(cut, 200);
  EXPECT_GT(whole, 200);
}

TEST(SafeShare, GoesAlmostAsFarAsTheKeptDistanceAllows) {
  RandomStream random("safe_share", 2);
  for (int trial = 0; trial < 500; ++trial) {
    const Vector2d tail(-random.uniform(0.5, 2), 1);
    const Vector2d head(random.uniform(0.5, 2), 1);
    const Vector2d change(random.normal(), -random.uniform(1, 5));
    const double share = conservative_ccd_step(tail, head, change, change, 0.2, 1);
    if (share == 1) continue;
    EXPECT_LT(searched_distance(tail + share * change, head + share * change), 0.2 + 0.05);
  }
}

TEST(SafeShare, LetsASegmentSlidePastAtAConstantDistance) {
  const Vector2d slide(1000, 0);
  EXPECT_EQ(conservative_ccd_step({-1, 1e-6}, {1, 1e-6}, slide, slide, 0.2, 1), 1);
  EXPECT_EQ(conservative_ccd_step({-1, 1e-6}, {1, 1e-6}, Vector2d::Zero(), Vector2d::Zero(), 0.2, 1), 1);
}

TEST(SafeShare, StopsAPointThatMovesAlongTheSegmentsLine) {
  const Vector2d approach(-4, 0);
  const double share = conservative_ccd_step({1, 0}, {2, 0}, approach, approach, 0.2, 1);
  EXPECT_NEAR(share, 0.2, 1e-12);
}

TEST(SafeShare, StopsASegmentThatTurnsOntoThePoint) {
  // The tail stays, and the head moves from above the tail to the right. At half the step, the segment crosses the
  // origin.
  const double share = conservative_ccd_step({-1, 0}, {-1, 2}, Vector2d::Zero(), Vector2d(4, -4), 0.2, 1);
  EXPECT_LT(share, 0.5);
  EXPECT_GT(share, 0.3);
}

TEST(StaysBeyond, IsNeverWrongWhereItIsSure) {
  RandomStream random("stays_beyond", 1);
  int sure = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const Vector2d tail = random_vector(random);
    const Vector2d head = random_vector(random);
    const Vector2d tail_change = random_vector(random);
    const Vector2d head_change = random_vector(random);
    if (!stays_beyond(tail, head, tail_change, head_change, 0.3)) continue;
    ++sure;
    for (int k = 0; k <= 25; ++k)
      ASSERT_GT(searched_distance(tail + k / 25.0 * tail_change, head + k / 25.0 * head_change), 0.3);
  }
  EXPECT_GT(sure, 100);
}

TEST(SegmentsCross, OnlyInPointsInsideBoth) {
  EXPECT_TRUE(segments_cross({-1, 0}, {1, 0}, {0, -1}, {0, 1}));
  EXPECT_FALSE(segments_cross({-1, 0}, {1, 0}, {0, 0}, {0, 1})) << "touches";
  EXPECT_FALSE(segments_cross({-1, 0}, {1, 0}, {1, 0}, {2, 1})) << "shares an end";
  EXPECT_FALSE(segments_cross({-1, 0}, {1, 0}, {-1, 1}, {1, 1})) << "parallel";
  EXPECT_FALSE(segments_cross({-1, 0}, {1, 0}, {0, 0}, {2, 0})) << "collinear";
  EXPECT_FALSE(segments_cross({-1, 0}, {1, 0}, {2, -1}, {2, 1})) << "crosses the line only";
}

TEST(SegmentsCross, NotWhereRoundingAloneTurnsSegmentsOfOneLine) {
  RandomStream random("segments_cross", 1);
  for (int trial = 0; trial < 10000; ++trial) {
    const Vector2d along = random_vector(random);
    const Vector2d start = random_vector(random);
    const auto at = [&](double t) { return Vector2d(start + t * along); };
    EXPECT_FALSE(segments_cross(at(0), at(0.1), at(0.1 + random.uniform(0.001, 0.3)), at(0.7)));
  }
}

}  // namespace
}  // namespace supple::microscale
