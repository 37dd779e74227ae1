#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "supple/base/random.h"
#include "supple/weave/homogenization.h"
#include "supple/weave/patterns.h"
#include "supple/weave/simulation.h"
#include "weave_path.h"

namespace supple::weave {
namespace {

using std::numbers::pi;

Strand line(Eigen::Vector2d from, Eigen::Vector2d to, double radius = 0.25) {
  return {StrandCurve({from, to}, Ends::open), radius};
}

std::vector<DirectionalResponse> respond(const Weave& weave, double strain, int count,
                                         const EquilibriumOptions& equilibrium = {}) {
  HomogenizationOptions options;
  options.strain = strain;
  options.directions = directions_over_half_turn(count);
  options.equilibrium = equilibrium;
  auto responses = homogenize(weave, options);
  for (const DirectionalResponse& r : responses) {
    EXPECT_EQ(r.state.stopped, Stop::converged) << r.direction;
    EXPECT_LE(r.state.residual, r.state.tolerance) << r.direction;
    EXPECT_TRUE(std::isfinite(r.youngs_modulus)) << r.direction;
    EXPECT_GE(r.state.energy_density, -1e-9) << r.direction;
  }
  return responses;
}

void expect_converged(const SimulationResult& result) {
  EXPECT_EQ(result.message, "");
  for (const SheetState& state : result.states) {
    EXPECT_EQ(state.stopped, Stop::converged);
    EXPECT_LE(state.residual, state.tolerance);
  }
}

TEST(HardWeaves, SlidersThatLockOnTheWayCarryTheLoadFromThenOn) {
  for (const double strain : {0.22, 0.235, 0.26, 0.40}) {
    const auto responses = respond(interlacing_squares(SquareType::all_slide_x), strain, 12);
    for (const DirectionalResponse& r : responses)
      for (const double u : r.state.sliding) EXPECT_LT(std::abs(u), 4.2) << "no slider passes its limit";
    if (strain > 0.25) {
      EXPECT_GT(responses[0].youngs_modulus, 20) << strain;
    }
  }
}

TEST(HardWeaves, DirectionsWithoutStiffnessConvergeToo) {
  // No crossing is fused: only the regularization resists rotating and sliding.
  for (const double strain : {0.02, 0.1, 0.2}) {
    const auto responses = respond(regular_weave(uniform_block(Connection::slides_y)), strain, 8);
    EXPECT_LT(std::abs(responses[2].youngs_modulus), 1) << strain;
    EXPECT_GT(responses[0].youngs_modulus, 1e5);
  }
}

TEST(HardWeaves, StrandsThatCrossNearlyParallelSlideAndBend) {
  for (const double angle : {0.05, 0.02}) {
    for (const bool slides : {false, true}) {
      Weave weave;
      weave.strands.push_back(line({-10, 0}, {10, 0}));
      weave.strands.push_back(
          line({-10 * std::cos(angle), -10 * std::sin(angle)}, {10 * std::cos(angle), 10 * std::sin(angle)}));
      weave.crossings = find_crossings(weave.strands);
      ASSERT_EQ(weave.crossings.size(), 1U);
      if (slides) {
        weave.crossings[0].members[1].slides = true;
        weave.crossings[0].members[1].backward = weave.crossings[0].members[1].forward = 3;
      }
      SheetLoad load;
      load.supports = {{0, 0}, {0, 20}, {1, 20, {true, true, true}, {2, 1, 0}}};
      load.supports[0].clamped = true;
      expect_converged(simulate(weave, load));
    }
  }
}

TEST(HardWeaves, CrossingsThatAreSqueezedTogetherStayApart) {
  // Two posts are moved towards each other along a strand that slides through both.
  Weave weave;
  weave.strands.push_back(line({0, 0}, {20, 0}));
  for (const double x : {8.0, 12.0}) weave.strands.push_back(line({x, -3}, {x, 3}));
  weave.crossings = find_crossings(weave.strands);
  for (Crossing& crossing : weave.crossings) crossing.members[0].slides = true;
  SheetLoad load;
  load.states = 8;
  load.supports = {{0, 0}, {0, 20}};
  for (int p = 1; p <= 2; ++p)
    for (const double s : {0.0, 6.0}) load.supports.push_back({p, s, {true, true, true}, {p == 1 ? 2.2 : -2.2, 0, 0}});
  EquilibriumOptions options;
  options.least_distance = 0.5;
  options.out_of_plane = Switch::off;
  const SimulationResult result = simulate(weave, load, options);
  expect_converged(result);
  for (const SheetState& state : result.states)
    EXPECT_GT(12 + state.sliding[1] - (8 + state.sliding[0]), 0.5 - 1e-6) << "they never come closer than 0.5 mm";
  EXPECT_GT(result.states.back().reactions[2].norm(), 1e-3) << "and push back";
}

TEST(HardWeaves, SixtyPercentOfStrainInEveryDirection) {
  for (int type = 1; type <= 4; ++type) respond(interlacing_squares(static_cast<SquareType>(type)), 0.6, 12);
  respond(interlacing_circles(CircleType::all_fused), 0.6, 12);
  respond(interlacing_circles(CircleType::all_slide), 0.6, 12);
}

TEST(HardWeaves, CompressionByThirtyPercentBucklesAndConverges) {
  EquilibriumOptions options;
  options.out_of_plane = Switch::off;
  for (int type = 1; type <= 4; ++type) respond(interlacing_squares(static_cast<SquareType>(type)), -0.3, 8, options);
  respond(interlacing_circles(CircleType::all_fused), -0.3, 8, options);
}

TEST(HardWeaves, ATwentyByTwentySlidingSheetIsShearedByThirtyPercent) {
  const double pitch = 4.5;
  const int n = 20;
  const Weave weave = regular_sheet(n, n, uniform_block(Connection::slides_x), pitch);
  SheetLoad load;
  for (int k = 0; k < n; ++k) {
    load.supports.push_back({0, (k + 0.5) * pitch});
    // The top row moves sideways and is free to sink: the strands turn and do not stretch.
    load.supports.push_back({n - 1, (k + 0.5) * pitch, {true, false, true}, {0.3 * (n - 1) * pitch, 0, 0}});
  }
  EquilibriumOptions options;
  options.segments = 2;
  const SimulationResult result = simulate(weave, load, options);
  expect_converged(result);
  EXPECT_FALSE(result.states.back().out_of_plane);
  EXPECT_LT(result.states.back().energy, 1) << "stretched by the same shear at constant height: 1139 N mm";
}

TEST(HardWeaves, AnInvertedStartUnfolds) {
  // Random displacements of more than a pitch fold the strands over each other; seeds 1 to 4.
  const Weave weave = regular_sheet(4, 4, uniform_block(Connection::fused));
  const RodModel model(weave, {{.strand = 0, .coordinate = 0}, {.strand = 0, .coordinate = 16}},
                       {.spatial = false, .segments = 2});
  std::vector<bool> held = gauge_constraints(model);
  for (std::size_t a = 0; a < 2; ++a)
    for (int c = 0; c < 2; ++c) held[static_cast<std::size_t>(model.position(model.anchor_node(a)) + c)] = true;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    RandomStream random("inverted_start", seed);
    Eigen::VectorXd q = model.rest_state();
    for (Eigen::Index i = 0; i < q.size(); ++i)
      if (!held[static_cast<std::size_t>(i)]) q[i] += random.uniform(-5, 5);
    WeaveSystem objective(model, q, {}, held, {});
    EquilibriumOptions options;
    options.max_iterations = 1000;
    const double before = objective.evaluate(0).value;
    WeavePath path(objective, options, {});
    EXPECT_TRUE(path.find_equilibrium()) << "seed " << seed << ' ' << to_string(path.termination()) << ' '
                                         << path.residual();
    EXPECT_LE(path.residual(), path.tolerance()) << "seed " << seed;
    EXPECT_LT(path.energy(), 0.01 * before) << "seed " << seed;
    EXPECT_TRUE(path.stable()) << "seed " << seed;
  }
}

TEST(HardWeaves, VeryThinAndVeryStiffStrandsInOneCell) {
  // With radii of 0.03 and 1 mm, bending stiffnesses differ by a factor of a million.
  Weave weave = regular_weave({{{Connection::fused, Connection::slides_x}, {Connection::slides_y, Connection::fused}}});
  weave.strands[0].radius = 0.03;
  weave.strands[2].radius = 1;
  respond(weave, 0.1, 12);
  Weave circles = interlacing_circles_sheet(CircleType::all_slide, 2, 2);
  circles.strands[0].radius = 0.02;
  circles.strands[3].radius = 1.5;
  SheetLoad load;
  load.supports = {{0, 0.5 * circles.strands[0].curve.length()}, {0, 0.6 * circles.strands[0].curve.length()}};
  load.supports.push_back({3, 0, {true, true, true}, {3, 1, 0}});
  expect_converged(simulate(circles, load));
}

TEST(HardWeaves, RandomLayoutsOfCurvedStrandsConvergeInEveryDirection) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    RandomStream random("random_layouts", seed);
    Weave weave;
    weave.lattice = Eigen::Matrix2d{{12, random.uniform(-3, 3)}, {0, 12}};
    for (int k = 0; k < 2; ++k) {
      weave.strands.push_back(
          {StrandCurve({{0, 3 + 6.0 * k + random.uniform(-1, 1)}, {6, 3 + 6.0 * k + random.uniform(-1, 1)}},
                       Ends::periodic, weave.lattice->col(0))});
      weave.strands.push_back(
          {StrandCurve({{3 + 6.0 * k + random.uniform(-1, 1), 0},
                        Eigen::Vector2d(3 + 6.0 * k + random.uniform(-1, 1), 0) + 0.5 * weave.lattice->col(1)},
                       Ends::periodic, weave.lattice->col(1))});
    }
    weave.crossings = find_crossings(weave.strands, weave.lattice);
    EXPECT_EQ(weave.crossings.size(), 4U) << "seed " << seed;
    for (Crossing& crossing : weave.crossings) {
      const int kind = random.below(3);
      if (kind < 2) crossing.members[static_cast<std::size_t>(kind)].slides = true;
      for (CrossingMember& m : crossing.members) m.backward = m.forward = random.uniform(0.5, 3);
    }
    SCOPED_TRACE("seed " + std::to_string(seed));
    respond(weave, 0.15, 6);
  }
}

}  // namespace
}  // namespace supple::weave
