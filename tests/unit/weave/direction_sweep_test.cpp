#include "direction_sweep.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "supple/weave/patterns.h"

namespace supple::weave {
namespace {

using std::numbers::pi;

TEST(DirectionSweep, KnowsHowTheEnergyChangesWithTheDirection) {
  const Weave weave = interlacing_squares(SquareType::one_corner_fused);
  for (const bool shear_free : {true, false}) {
    HomogenizationOptions options;
    options.shear_free = shear_free;
    options.equilibrium.tolerance = 1e-10;
    options.equilibrium.out_of_plane = Switch::off;
    const double h = 1e-4;
    options.directions = {0.4 - h, 0.4, 0.4 + h};
    const auto responses = homogenize(weave, options);
    const double slope = (responses[2].state.energy_density - responses[0].state.energy_density) / (2 * h);
    EXPECT_GT(std::abs(slope), 1e-3);
    EXPECT_NEAR(energy_slope(responses[1], options), slope, 1e-5 * std::abs(slope)) << shear_free;
  }
}

/// Responses whose energy is 2 + cos(2 angle), with the stress that belongs to it.
std::vector<DirectionalResponse> smooth_energies(const HomogenizationOptions& options) {
  std::vector<DirectionalResponse> responses;
  for (const double angle : options.directions) {
    DirectionalResponse& response = responses.emplace_back();
    response.direction = angle;
    const Eigen::Vector2d d(std::cos(angle), std::sin(angle));
    const Eigen::Vector2d n(-d[1], d[0]);
    response.state.energy_density = 2 + std::cos(2 * angle);
    response.state.deformation_gradient = Eigen::Matrix2d::Identity() + options.strain * d * d.transpose();
    // The slope d^T P (stretch n - F^T n) is then strain d^T P n.
    response.state.nominal_stress = -2 * std::sin(2 * angle) / options.strain * d * n.transpose();
  }
  return responses;
}

TEST(DirectionSweep, SuspectsEnergiesThatTheirNeighboursDoNotExplainAndNoOthers) {
  HomogenizationOptions options;
  options.directions = directions_over_half_turn(24);
  auto responses = smooth_energies(options);
  const DirectionOrder order(responses);
  EXPECT_TRUE(suspicious_directions(responses, order, options).empty());
  responses[7].state.energy_density *= 1.2;
  auto starts = suspicious_directions(responses, order, options);
  ASSERT_EQ(starts.size(), 2U);
  EXPECT_EQ(starts[0].position, 6U);
  EXPECT_TRUE(starts[0].upwards);
  EXPECT_EQ(starts[1].position, 8U);
  EXPECT_FALSE(starts[1].upwards);
  responses[7].state.stopped = Stop::iteration_limit;
  EXPECT_EQ(suspicious_directions(responses, order, options).size(), 2U) << "one that has no equilibrium is suspicious";
  responses[7].state.stopped = Stop::folded_flat;
  EXPECT_TRUE(suspicious_directions(responses, order, options).empty());
}

TEST(DirectionSweep, GoesAroundTheHalfTurnAndAcrossNoWideGap) {
  HomogenizationOptions options;
  options.directions = {3.1, 0.05, 0.1, 1, -3};
  const DirectionOrder order(smooth_energies(options));
  ASSERT_EQ(order.size(), 5U);
  EXPECT_EQ(order.index(0), 1U);
  EXPECT_EQ(order.index(2), 4U) << "-3 rad is 0.14";
  EXPECT_EQ(order.neighbour(4, true), 0U);
  EXPECT_EQ(order.neighbour(0, false), 4U);
  EXPECT_FALSE(order.neighbour(2, true));
  EXPECT_FALSE(order.neighbour(3, true));
  EXPECT_FALSE(DirectionOrder(smooth_energies({.directions = {1}})).neighbour(0, true));
}

TEST(DirectionSweep, TakesLowerEnergiesAndCountsWhatTheyCost) {
  HomogenizationOptions options;
  options.directions = {0, 0.1};
  auto responses = smooth_energies(options);
  responses[1].state.iterations = 10;
  DirectionalResponse lower = responses[1];
  lower.state.energy_density /= 2;
  lower.state.iterations = 3;
  EXPECT_TRUE(is_better(lower, responses[1]));
  EXPECT_FALSE(is_better(responses[1], lower));
  DirectionalResponse unstable = lower;
  unstable.state.stable = false;
  EXPECT_FALSE(is_better(unstable, responses[1]));
  replace_by_better({{1, lower}, {1, responses[1]}}, responses);
  EXPECT_EQ(responses[1].state.energy_density, lower.state.energy_density);
  EXPECT_EQ(responses[1].state.iterations, 13);
  EXPECT_EQ(responses[1].state.branches, 1);
}

}  // namespace
}  // namespace supple::weave
