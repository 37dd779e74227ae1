#include "supple/surface/vertex_cone.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "supple/base/random.h"
#include "supple/surface/exponential_map.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using std::numbers::pi;

/// The least of the directional derivative over many sampled directions, written down independently.
double sampled_slope(double total, bool open, const std::vector<ArrivingPath>& arrivals) {
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k <= 100000; ++k) {
    const double u = total * k / 100000;
    double sum = 0;
    for (const ArrivingPath& a : arrivals) {
      double turn = std::abs(u - a.angle);
      if (!open) turn = std::min(turn, total - turn);
      sum += turn >= pi ? a.weight : -a.weight * std::cos(turn);
    }
    least = std::min(least, sum);
  }
  return least;
}

TEST(VertexCone, AnglesAroundAnApexAddUpToItsConeAngle) {
  for (const double angle : {2.0, 5.0, 2 * pi, 8.0}) {
    const TriangleMesh mesh = testing::cone(8, angle);
    const VertexCone cone(mesh, 0);
    EXPECT_NEAR(cone.total_angle(), angle, 1e-12);
    EXPECT_FALSE(cone.open());
    EXPECT_EQ(cone.bends_paths(), angle > 2 * pi + 1e-6);
  }
}

TEST(VertexCone, OnlyAReflexBoundaryVertexBendsPaths) {
  const TriangleMesh mesh = testing::l_shape(2);
  int bending = 0;
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
    if (!VertexCone(mesh, v).bends_paths()) continue;
    ++bending;
    EXPECT_LT((mesh.positions()[v] - Eigen::Vector3d(1, 1, 0)).norm(), 1e-12);
  }
  EXPECT_EQ(bending, 1);
}

TEST(VertexCone, ADirectionLeadsToAPointThatIsSeenUnderItsAngle) {
  for (const TriangleMesh& mesh : {testing::cone(8, 8.0), testing::cone(6, 4.0), testing::l_shape(3)}) {
    const VertexCone cone(mesh, 0);
    for (int k = 0; k < 50; ++k) {
      const double angle = cone.total_angle() * (k + 0.3) / 50;
      const auto direction = cone.direction(angle);
      EXPECT_NEAR(direction.vector.norm(), 1, 1e-14);
      const ExponentialMap walked = exponential_map(mesh, direction.vertex, 0.1 * direction.vector, {});
      EXPECT_NEAR(cone.angle_to(walked.end), angle, 1e-10);
    }
  }
}

TEST(VertexCone, TheAngleToAPointOfNoFaceOfTheVertexIsNotANumber) {
  const TriangleMesh mesh = testing::cone(8, 8.0, 3);
  const VertexCone cone(mesh, 0);
  const SurfacePoint far{FaceId{mesh.face_count() - 1}, Eigen::Vector3d(0.2, 0.3, 0.5)};
  EXPECT_TRUE(std::isnan(cone.angle_to(far)));
}

TEST(SteepestDescent, IsTheLeastOfAllDirectionsOnClosedAndOpenCones) {
  RandomStream random("steepest_descent", 1);
  for (const double angle : {2.0, 5.0, 2 * pi, 8.0, 15.0}) {
    const TriangleMesh mesh = testing::cone(8, angle);
    const VertexCone cone(mesh, 0);
    for (int trial = 0; trial < 20; ++trial) {
      std::vector<ArrivingPath> arrivals(1 + random.below(6));
      for (ArrivingPath& a : arrivals) a = {random.uniform(0, angle), random.uniform(0.1, 2)};
      const SteepestDescent descent = steepest_descent(cone, arrivals);
      const double sampled = sampled_slope(angle, false, arrivals);
      EXPECT_LE(descent.slope, sampled + 1e-12);
      EXPECT_NEAR(descent.slope, sampled, 1e-3) << "no direction has so small a slope";
    }
  }
  const TriangleMesh mesh = testing::l_shape(2);
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
    const VertexCone cone(mesh, v);
    if (!cone.open()) continue;
    std::vector<ArrivingPath> arrivals(3);
    for (ArrivingPath& a : arrivals) a = {random.uniform(0, cone.total_angle()), random.uniform(0.1, 2)};
    const double sampled = sampled_slope(cone.total_angle(), true, arrivals);
    EXPECT_NEAR(steepest_descent(cone, arrivals).slope, sampled, 1e-3);
  }
}

TEST(SteepestDescent, AtAFlatVertexIsTheGradientsLength) {
  const TriangleMesh mesh = testing::cone(8, 2 * pi);
  const VertexCone cone(mesh, 0);
  const std::vector<ArrivingPath> arrivals{{0.3, 1.0}, {1.9, 0.5}, {4.0, 2.0}};
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const ArrivingPath& a : arrivals) sum += a.weight * Eigen::Vector2d(std::cos(a.angle), std::sin(a.angle));
  const SteepestDescent descent = steepest_descent(cone, arrivals);
  EXPECT_NEAR(descent.slope, -sum.norm(), 1e-12);
  EXPECT_NEAR(std::remainder(descent.angle - std::atan2(sum.y(), sum.x()), 2 * pi), 0, 1e-9);
}

TEST(SteepestDescent, ExistsAtEveryConvexApexAndNotAtASaddleWithPathsFromAllSides) {
  RandomStream random("convex_apex", 1);
  const TriangleMesh convex = testing::cone(8, 5.5);
  const VertexCone convex_cone(convex, 0);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<ArrivingPath> arrivals(1 + random.below(8));
    for (ArrivingPath& a : arrivals) a = {random.uniform(0, 5.5), random.uniform(0.1, 2)};
    EXPECT_LT(steepest_descent(convex_cone, arrivals).slope, 0);
  }
  const TriangleMesh saddle = testing::cone(8, 9.0);
  std::vector<ArrivingPath> around;
  for (int k = 0; k < 5; ++k) around.push_back({9.0 * k / 5, 1});
  EXPECT_GT(steepest_descent(VertexCone(saddle, 0), around).slope, 0.1);
}

}  // namespace
}  // namespace supple::surface
