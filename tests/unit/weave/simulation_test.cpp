#include "supple/weave/simulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "layouts.h"
#include "supple/base/threads.h"
#include "supple/weave/drawing.h"
#include "supple/weave/patterns.h"
#include "supple/weave/weave_error.h"
#include "support/expect_error.h"

namespace supple::weave {
namespace {

using std::numbers::pi;

void expect_converged(const SimulationResult& result) {
  EXPECT_EQ(result.message, "");
  for (const SheetState& state : result.states) {
    EXPECT_EQ(state.stopped, Stop::converged);
    EXPECT_LE(state.residual, state.tolerance);
    EXPECT_TRUE(state.stable);
  }
}

/// A strand through three posts, which are short strands whose ends are fixed. The strand can slide by 2 mm to either
/// side.
Weave strand_through_posts() {
  Weave weave;
  weave.strands.push_back(line({0, 0}, {20, 0}));
  for (const double x : {4.0, 10.0, 16.0}) weave.strands.push_back(line({x, -3}, {x, 3}));
  weave.crossings = find_crossings(weave.strands);
  for (Crossing& crossing : weave.crossings) {
    crossing.members[0].slides = true;
    crossing.members[0].backward = 2;
    crossing.members[0].forward = 2;
  }
  return weave;
}

SheetLoad posts_held(int posts) {
  SheetLoad load;
  for (int p = 1; p <= posts; ++p)
    for (const double s : {0.0, 6.0}) load.supports.push_back({p, s});
  return load;
}

TEST(Sliding, AStraightStrandIsPulledFreelyToItsLimitAndThenLoads) {
  const Weave weave = strand_through_posts();
  SheetLoad load = posts_held(3);
  load.states = 15;
  load.supports.push_back({0, 20, {true, true, true}, {3, 0, 0}});
  const SimulationResult result = simulate(weave, load);
  expect_converged(result);
  for (const SheetState& state : result.states) {
    const double pulled = 3 * state.share;
    const double force = state.reactions.back()[0];
    if (pulled < 1.85) {
      EXPECT_LT(std::abs(force), 1e-4) << pulled << " mm";
      for (const double u : state.sliding) EXPECT_NEAR(u, -pulled, 1e-3);
    } else if (pulled > 2.1) {
      EXPECT_GT(force, 0.1) << pulled << " mm";
    }
  }
  EXPECT_GT(result.states.back().reactions.back()[0], 3 * result.states[10].reactions.back()[0]);
}

TEST(Sliding, ACurvedStrandIsPushedAlongItselfFreelyToItsLimitAndThenLoads) {
  Weave weave;
  weave.strands.push_back(arc(10, 2 * pi / 3, 60));
  for (const double angle : {pi / 6, pi / 3, pi / 2}) {
    const Eigen::Vector2d d(std::cos(angle), std::sin(angle));
    weave.strands.push_back(line(7 * d, 13 * d));
  }
  weave.crossings = find_crossings(weave.strands);
  ASSERT_EQ(weave.crossings.size(), 3U);
  for (Crossing& crossing : weave.crossings) {
    crossing.members[0].slides = true;
    crossing.members[0].forward = 1.2;
  }
  // Its end is pulled down and is free to move sideways: the arc rotates about its centre.
  SheetLoad load = posts_held(3);
  load.states = 10;
  load.supports.push_back({0, 0, {false, true, false}, {0, -1.6, 0}});
  const SimulationResult result = simulate(weave, load, {.out_of_plane = Switch::off});
  expect_converged(result);
  for (const SheetState& state : result.states) {
    const double turned = 10 * std::asin(0.16 * state.share);
    if (turned < 1.05) {
      for (const double u : state.sliding) EXPECT_NEAR(u, turned, 2e-3);
      EXPECT_LT(std::abs(state.reactions.back()[1]), 1e-3);
    } else if (turned > 1.3) {
      EXPECT_LT(state.reactions.back()[1], -0.05);
    }
  }
}

TEST(Sliding, EnergyDoesNotDependOnHowAStraightStrandIsCut) {
  const Weave weave = strand_through_posts();
  SheetLoad load = posts_held(3);
  // Both ends are pulled outwards: the strand stretches evenly through its posts, which do not move.
  load.supports.push_back({0, 0, {true, true, true}, {-0.15, 0, 0}});
  load.supports.push_back({0, 20, {true, true, true}, {0.15, 0, 0}});
  const double exact = 0.5 * circular(0.25, {}).stretch * 0.3 * 0.3 / 20;
  for (const int segments : {1, 2, 5, 9}) {
    const SimulationResult result = simulate(weave, load, {.segments = segments, .tolerance = 1e-9});
    expect_converged(result);
    EXPECT_NEAR(result.states.back().energy, exact, 1e-6 * exact) << segments;
  }
}

TEST(Simulation, ReactionsBalanceTheForces) {
  Weave weave = wavy();
  SheetLoad load;
  load.supports.push_back({2, 0, {true, true, true}, {0, 0, 0}, true});
  load.supports.push_back({4, 0});
  load.supports.push_back({3, 0});
  load.forces.push_back({1, 0, {0.02, 0.05, 0.01}});
  const SimulationResult result = simulate(weave, load, {.tolerance = 1e-8});
  expect_converged(result);
  EXPECT_TRUE(result.states.back().out_of_plane) << "the force leaves the plane";
  Eigen::Vector3d sum(0.02, 0.05, 0.01);
  for (const Eigen::Vector3d& reaction : result.states.back().reactions) sum += reaction;
  EXPECT_LT(sum.norm(), 1e-6);
}

TEST(Sheets, FusedOnesLeaveThePlaneWhereSlidingOnesShearInIt) {
  const double pitch = 4.5;
  const int n = 8;
  // One corner is fixed, and the opposite one is moved towards it along the diagonal.
  SheetLoad load;
  load.supports.push_back({0, 0.5 * pitch});
  load.supports.push_back({0, 1.5 * pitch});
  load.supports.push_back({n, 1.5 * pitch});
  load.supports.push_back({n - 1, (n - 0.5) * pitch, {true, true, true}, {-4.5, -4.5, 0}});
  double fused_energy = 0;
  for (const Connection connection : {Connection::fused, Connection::slides_x}) {
    const Weave weave = regular_sheet(n, n, uniform_block(connection), pitch);
    const SimulationResult result = simulate(weave, load, {.segments = 2});
    EXPECT_EQ(result.message, "");
    const SheetState& state = result.states.back();
    EXPECT_EQ(state.stopped, Stop::converged);
    EXPECT_LE(state.residual, state.tolerance);
    double height = 0;
    for (const Eigen::Vector3d& p : state.crossings) height = std::max(height, std::abs(p[2]));
    if (connection == Connection::fused) {
      EXPECT_TRUE(state.out_of_plane);
      EXPECT_GT(height, 1);
      fused_energy = state.energy;
    } else {
      EXPECT_LT(height, 0.2);
      EXPECT_LT(state.energy, 0.1 * fused_energy);
    }
  }
}

TEST(Sheets, HaveTheSameBitsForAnyNumberOfThreads) {
  const int n = 6;
  const Weave weave = regular_sheet(n, n, uniform_block(Connection::fused), 4.5);
  SheetLoad load;
  load.supports.push_back({0, 2.25});
  load.supports.push_back({0, 6.75});
  load.supports.push_back({n, 6.75});
  load.supports.push_back({n - 1, (n - 0.5) * 4.5, {true, true, true}, {-4, -4, 0}});
  std::vector<SimulationResult> results;
  for (const int threads : {1, 2, 3}) {
    set_thread_count(threads);
    results.push_back(simulate(weave, load, {.segments = 2}));
  }
  set_thread_count(0);
  EXPECT_TRUE(results[0].states.back().out_of_plane) << "turns in space are on the way";
  for (const auto& result : results) {
    EXPECT_EQ(result.states.back().energy, results[0].states.back().energy);
    EXPECT_EQ(result.states.back().strands, results[0].states.back().strands);
  }
}

TEST(ActuatedRings, RiseToADomeWhereTheirStrandIsPushedIn) {
  const Weave weave = actuated_rings();
  const auto pushed = static_cast<int>(weave.strands.size()) - 1;
  SheetLoad load;
  load.states = 4;
  load.supports.push_back({2, 0.75 * weave.strands[2].curve.length(), {true, true, true}, {0, 0, 0}, true});
  load.supports.push_back({pushed, 72, {true, true, true}, {0, 10, 0}});
  CostLedger ledger;
  Execution execution;
  execution.cost = &ledger;
  const SimulationResult result = simulate(weave, load, {.segments = 2}, execution);
  expect_converged(result);
  double last = 0;
  for (const SheetState& state : result.states) {
    double height = 0;
    for (const Eigen::Vector3d& p : state.crossings) height = std::max(height, std::abs(p[2]));
    EXPECT_GT(height, last + 1);
    last = height;
    EXPECT_TRUE(state.out_of_plane);
  }
  EXPECT_GT(last, 10);
  std::map<std::string, CostLedger::Effect> effects;
  for (const auto& effect : ledger.effects()) effects[effect.name] = effect;
  EXPECT_TRUE(effects.at("out_of_plane").ran);
  EXPECT_EQ(effects.at("out_of_plane").why, "a planar equilibrium was unstable against a mode out of its plane");
  EXPECT_TRUE(effects.at("twist").ran);
}

TEST(Simulation, CarriesFramesAndJointsFromStateToState) {
  // A clamped end makes one and a half turns about the strand, and the clamp at the other end keeps the twist. The
  // twist grows evenly from state to state. Frames that were constructed anew would lose it beyond half a turn.
  Weave weave;
  weave.strands.push_back(line({0, 0}, {10, 0}, 0.5));
  SheetLoad load;
  load.states = 6;
  load.supports.push_back({0, 0, {true, true, true}, {0, 0, 0}, true});
  load.supports.push_back({0, 10, {true, true, true}, {0, 0, 0}, true, {3 * pi, 0, 0}});
  EquilibriumOptions options;
  options.buckling = Switch::off;
  const SimulationResult result = simulate(weave, load, options);
  ASSERT_EQ(result.states.size(), 6U);
  for (const SheetState& state : result.states) {
    const double exact = 0.5 * circular(0.5, {}).twist * std::pow(3 * pi * state.share, 2) / 10;
    EXPECT_NEAR(state.energy, exact, 1e-6 * exact) << state.share;
  }
}

/// Requests a stop once this many tasks or states are finished.
struct Stopper : ProgressSink {
  Stopper(StopReason its_reason, double its_fraction) : reason(its_reason), fraction(its_fraction) {}
  void report(double done, std::string_view stage) override {
    if (stage == "states" && done >= fraction - 1e-12) token.request(reason);
  }
  CancellationToken token;
  StopReason reason;
  double fraction;
};

TEST(Simulation, KeepsTheStatesThatWereFinishedIfTimeOrMemoryRunsOut) {
  const Weave weave = strand_through_posts();
  SheetLoad load = posts_held(3);
  load.states = 6;
  load.supports.push_back({0, 20, {true, true, true}, {3, 0, 0}});
  const SimulationResult whole = simulate(weave, load);
  for (const StopReason reason : {StopReason::deadline, StopReason::memory}) {
    Stopper stopper(reason, 0.5);
    const SimulationResult result = simulate(weave, load, {}, {.cancellation = stopper.token, .progress = &stopper});
    ASSERT_EQ(result.states.size(), 3U);
    EXPECT_EQ(result.states.back().stopped, reason == StopReason::deadline ? Stop::deadline : Stop::memory);
    EXPECT_EQ(result.states.front().stopped, Stop::converged);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(result.states[k].energy, whole.states[k].energy);
    EXPECT_NE(result.message.find("after the equilibrium under 0.5 of the loads"), std::string::npos) << result.message;
    EXPECT_FALSE(stopper.token.requested()) << "the report goes on";
  }
  Stopper first(StopReason::deadline, 0);
  ::supple::testing::expect_cancelled(
      StopReason::deadline, [&] { simulate(weave, load, {}, {.cancellation = first.token, .progress = &first}); });
  Stopper cancelled(StopReason::cancelled, 0.5);
  ::supple::testing::expect_cancelled(StopReason::cancelled, [&] {
    simulate(weave, load, {}, {.cancellation = cancelled.token, .progress = &cancelled});
  });
}

TEST(Simulation, BillsTheStatesThatWereComparedBeforeTimeOrMemoryRanOut) {
  const Weave weave = strand_through_posts();
  SheetLoad load = posts_held(3);
  load.states = 6;
  load.supports.push_back({0, 20, {true, true, true}, {3, 0, 0}});
  // The estimate begins at 0.7 of the progress, and has compared as many of the 6 states as `compared` by then.
  for (const std::size_t compared : {6U, 3U, 0U}) {
    Stopper stopper(StopReason::deadline, compared == 6 ? 2 : 0.7 + 0.3 * static_cast<double>(compared) / 6);
    CostLedger ledger;
    const SimulationResult result =
        simulate(weave, load, {.error_estimate = Switch::on}, {stopper.token, &stopper, &ledger});
    expect_converged(result);
    ASSERT_EQ(result.states.size(), 6U);
    for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(std::isfinite(result.states[k].energy_error), k < compared) << k;
    const auto effect = std::ranges::find(ledger.effects(), "error_estimate", &CostLedger::Effect::name);
    ASSERT_NE(effect, ledger.effects().end());
    EXPECT_EQ(effect->ran, compared > 0) << effect->why;
    EXPECT_EQ(effect->count, static_cast<std::int64_t>(compared)) << effect->why;
    EXPECT_EQ(std::ranges::count(ledger.stages(), "error estimate", &CostLedger::Stage::name), 1);
  }
}

TEST(Simulation, RefusesLoadsThatCannotBeImposed) {
  const Weave weave = strand_through_posts();
  const auto places_of = [&](const SheetLoad& load) {
    return ::supple::testing::places(
        ::supple::testing::expect_error<InvalidLoad>("weave.invalid_load", [&] { simulate(weave, load); }));
  };
  EXPECT_EQ(places_of({}), std::vector<std::string>{"supports"});
  SheetLoad load;
  load.supports.push_back({7, 0});
  load.supports.push_back({0, 21});
  EXPECT_EQ(places_of(load), (std::vector<std::string>{"supports/0/strand", "supports/1/coordinate"}));
  load.supports = {{.strand = 0, .coordinate = 4, .clamped = true}};
  EXPECT_EQ(places_of(load), std::vector<std::string>{"supports/0/clamped"});
  load.supports = {{.strand = 0}};
  load.supports = {{.strand = 0, .coordinate = 4}, {.strand = 1, .coordinate = 3}};
  EXPECT_EQ(places_of(load).front(), "supports/1") << "the crossing is held through both of its strands";
  load.supports = {{.strand = 0}};
  load.forces = {{0, 1, {NAN, 0, 0}}};
  EXPECT_EQ(places_of(load), std::vector<std::string>{"forces/0/force"});
}

TEST(Simulation, IsCancelledWhereItIsAskedToStop) {
  Execution execution;
  execution.cancellation.request(StopReason::cancelled);
  SheetLoad load = posts_held(3);
  ::supple::testing::expect_cancelled(StopReason::cancelled,
                                      [&] { simulate(strand_through_posts(), load, {}, execution); });
}

TEST(Drawing, ShowsEveryStrandAndCrossing) {
  const Weave weave = wavy();
  const std::string svg = to_svg(weave);
  const auto count = [&svg](const std::string& what) {
    int n = 0;
    for (auto at = svg.find(what); at != std::string::npos; at = svg.find(what, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(svg.rfind("<svg ", 0), 0U);
  EXPECT_EQ(count("<circle"), 6);
  EXPECT_EQ(count("<path"), 5 + 5) << "strands, and a line at each crossing that slides";
  EXPECT_EQ(count("nan"), 0);
}

// The end of a ring's coordinates is the place where they begin: a separate node there would be at a distance of zero.
TEST(Supports, HoldTheSamePlaceOfARingAtBothEndsOfItsCoordinates) {
  const auto energy = [](double rotated, bool with_crossing) {
    Weave weave;
    weave.strands.push_back(circle(5));
    const double length = weave.strands[0].curve.length();
    const Eigen::Vector2d at = weave.strands[0].curve.at(0).position;
    if (with_crossing) {
      weave.strands.push_back(line(at - Eigen::Vector2d(3, 0.5), at + Eigen::Vector2d(3, 0.5)));
      weave.crossings = find_crossings(weave.strands);
    }
    SheetLoad load;
    load.supports.push_back({0, length / 2});
    load.supports.push_back({0, rotated * length, {true, true, true}, {0.3, 0, 0}});
    if (with_crossing) load.supports.push_back({1, 0});
    const SimulationResult result = simulate(weave, load);
    expect_converged(result);
    return result.states.back().energy;
  };
  for (const bool with_crossing : {false, true}) {
    const double expected = energy(0, with_crossing);
    EXPECT_GT(expected, 0);
    for (const double share : {1.0, 1 - 1e-16, 1 - 1e-12, 1 - 1e-8})
      EXPECT_NEAR(energy(share, with_crossing), expected, 1e-6 * expected) << share;
  }
}

}  // namespace
}  // namespace supple::weave
