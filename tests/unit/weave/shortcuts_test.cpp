#include "supple/weave/shortcuts.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "supple/weave/patterns.h"

namespace supple::weave {
namespace {

TEST(WeaveOf, LaysOutStrandsThroughTheRowsAndFusesThemWhereTheyCross) {
  const Eigen::MatrixXd across = (Eigen::MatrixXd(2, 2) << 0, 5, 10, 5).finished();
  const Eigen::MatrixXd up = (Eigen::MatrixXd(3, 2) << 4, 0, 4, 5, 4, 10).finished();
  const Weave weave = weave_of({across, up}, 0.3);
  ASSERT_EQ(weave.strands.size(), 2u);
  EXPECT_EQ(weave.strands[1].radius, 0.3);
  EXPECT_NEAR(weave.strands[1].curve.length(), 10, 1e-12);
  ASSERT_EQ(weave.crossings.size(), 1u);
  for (const CrossingMember& member : weave.crossings[0].members) {
    EXPECT_FALSE(member.slides);
    EXPECT_LT((rest_position(weave, member) - Eigen::Vector2d(4, 5)).norm(), 1e-9);
  }
  EXPECT_THROW(weave_of({Eigen::MatrixXd::Zero(2, 3)}), std::invalid_argument);
}

TEST(HomogenizationOverHalfATurn, IsThatOfTheseDirections) {
  const Weave grid = regular_weave(uniform_block(Connection::fused));
  HomogenizationOptions options;
  options.strain = 0.05;
  options.directions = directions_over_half_turn(4);
  const auto expected = homogenize(grid, options);
  const auto found = homogenize_over_half_turn(grid, 4, 0.05);
  EXPECT_EQ(youngs_moduli(found), youngs_moduli(expected));
  EXPECT_EQ(poisson_ratios(found), poisson_ratios(expected));
  ASSERT_EQ(youngs_moduli(found).size(), 4);
  EXPECT_EQ(youngs_moduli(found)[2], expected[2].youngs_modulus);
}

}  // namespace
}  // namespace supple::weave
