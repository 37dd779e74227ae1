#include "supple/design/target.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "supple/design/design_fault.h"
#include "support/expect_error.h"

namespace supple::design {
namespace {

using supple::testing::expect_error;
using supple::testing::places;

using std::numbers::pi;

Target curve() {
  Target target;
  target.control_points = {{-0.1, -2}, {0, 0}, {0.2, 3}};
  return target;
}

Target directions() {
  Target target;
  target.task = Task::poisson;
  target.control_points = {{0.2, 0.3}, {1, -0.2}, {3, 0.1}};
  return target;
}

TEST(Target, IsSampledBetweenItsEnds) {
  auto target = curve();
  target.samples = 7;
  const auto sampled = sample_target(target);
  ASSERT_EQ(sampled.samples.x.size(), 7U);
  EXPECT_DOUBLE_EQ(sampled.samples.x.front(), -0.1);
  EXPECT_DOUBLE_EQ(sampled.samples.x.back(), 0.2);
  EXPECT_NEAR(sampled.samples.x[2], 0, 1e-15);
  EXPECT_NEAR(sampled.y[2], 0, 1e-14);
  EXPECT_NEAR(sampled.y[6], 3, 1e-14);
  EXPECT_NEAR(sampled.weights.sum(), 1, 1e-15);
}

TEST(Target, OverDirectionsIsSampledAllAround) {
  const auto sampled = sample_target(directions());
  ASSERT_EQ(sampled.y.size(), 50);
  EXPECT_DOUBLE_EQ(sampled.samples.x[1], pi / 50);
  EXPECT_DOUBLE_EQ(sampled.samples.x.front(), 0);
}

TEST(Target, DeviationsWithinTheBandsCountAsNone) {
  auto target = curve();
  target.samples = 2;
  target.bands = {0.5, 0, 1};
  const auto sampled = sample_target(target);
  EXPECT_EQ(sampled.deviations(Eigen::Vector2d(-2.4, 3.9)), Eigen::Vector2d(0, 0));
  EXPECT_LT((sampled.deviations(Eigen::Vector2d(-2.75, 4.25)) - Eigen::Vector2d(-0.25, 0.25)).norm(), 1e-14);
}

TEST(Target, WeightsAndTheScaleBelongTogether) {
  auto target = curve();
  target.samples = 2;
  target.weights = {3, 1, 1};
  const auto sampled = sample_target(target);
  EXPECT_NEAR(sampled.weights[0], 0.75, 1e-15);
  EXPECT_NEAR(sampled.scale, std::sqrt(0.75 * 4 + 0.25 * 9), 1e-14);
  target.weights = {0, 1, 0};
  EXPECT_NEAR(sample_target(target).weights[0], 0.5, 1e-15) << "weights that vanish at all samples count alike";
}

TEST(Target, OfNoPoissonsRatioIsMeasuredAgainstATenth) {
  auto target = directions();
  for (auto& point : target.control_points) point[1] = 0;
  EXPECT_EQ(sample_target(target).scale, 0.1);
}

TEST(Target, OfPoissonsRatioToleratesAtLeast2Hundredths) {
  auto target = directions();
  for (auto& point : target.control_points) point[1] = 0.01;
  auto sampled = sample_target(target);
  EXPECT_EQ(sampled.tolerance(), 0.02);
  EXPECT_TRUE(sampled.is_reached(Eigen::VectorXd::Constant(50, 0.0299)));
  EXPECT_FALSE(sampled.is_reached(Eigen::VectorXd::Constant(50, 0.0301)));
  for (auto& point : target.control_points) point[1] = 5;
  EXPECT_NEAR(sample_target(target).tolerance(), 0.05, 1e-12);
  target.task = Task::stiffness;
  for (auto& point : target.control_points) point[1] = 0.1;
  EXPECT_NEAR(sample_target(target).tolerance(), 0.001, 1e-12) << "stiffnesses are relative";
}

TEST(Target, CoarsenedIsPartOfTheSameCurve) {
  const auto fine = sample_target(directions());
  const auto coarse = coarsened(fine, 10);
  ASSERT_EQ(coarse.y.size(), 10);
  EXPECT_EQ(coarse.samples.x[1], fine.samples.x[5]);
  EXPECT_EQ(coarse.y[9], fine.y[45]);
  auto target = curve();
  target.samples = 31;
  const auto strains = coarsened(sample_target(target), 4);
  EXPECT_DOUBLE_EQ(strains.samples.x.front(), -0.1);
  EXPECT_DOUBLE_EQ(strains.samples.x.back(), 0.2);
  EXPECT_EQ(coarsened(fine, 80).y.size(), 50) << "never finer";
}

TEST(Target, SaysWhichControlPointIsWrong) {
  auto target = curve();
  target.control_points[2][0] = 0;
  EXPECT_EQ(places(expect_error<InvalidTarget>("design.invalid_target", [&] { sample_target(target); })),
            std::vector<std::string>{"target/control_points/2/0"});
  target = curve();
  target.bands = {1, 2};
  EXPECT_EQ(places(expect_error<InvalidTarget>("design.invalid_target", [&] { sample_target(target); })),
            std::vector<std::string>{"target/bands"});
  target = directions();
  target.control_points[2][0] = 0.2 + pi;
  EXPECT_EQ(places(expect_error<InvalidTarget>("design.invalid_target", [&] { sample_target(target); })),
            std::vector<std::string>{"target/control_points/2/0"});
  target = curve();
  for (const double nearly_the_same : {5e-324, 1e-15, 1e-11}) {
    target.control_points[1][0] = target.control_points[0][0] + nearly_the_same;
    EXPECT_EQ(places(expect_error<InvalidTarget>("design.invalid_target", [&] { sample_target(target); })),
              std::vector<std::string>{"target/control_points/1/0"})
        << nearly_the_same;
  }
  target = curve();
  target.control_points[1][1] = -1.0000001e6;
  EXPECT_EQ(places(expect_error<InvalidTarget>("design.invalid_target", [&] { sample_target(target); })),
            std::vector<std::string>{"target/control_points/1"});
  target.control_points[1][1] = -1e6;
  EXPECT_NO_THROW(sample_target(target));
  target.control_points.resize(1);
  EXPECT_EQ(places(expect_error<InvalidTarget>("design.invalid_target", [&] { sample_target(target); })),
            std::vector<std::string>{"target/control_points"});
}

}  // namespace
}  // namespace supple::design
