#include "supple/design/polish.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <new>

#include "displaced_simulation.h"
#include "support/expect_error.h"

namespace supple::design {
namespace {

using supple::testing::expect_cancelled;

TEST(Polish, KeepsToItsRounds) {
  for (const int most : {0, 1, 3}) {
    Missed missed;
    const auto polished = missed.polished({.tolerance = 1e-9, .max_rounds = most});
    EXPECT_EQ(polished.rounds.size(), static_cast<std::size_t>(most) + 1);
    EXPECT_EQ(polished.stopped, PolishTermination::round_limit);
  }
}

TEST(Polish, KeepsToItsSeconds) {
  Missed missed;
  const auto polished = missed.polished({.tolerance = 1e-9, .max_seconds = 1e-9});
  EXPECT_EQ(polished.rounds.size(), 1U);
  EXPECT_EQ(polished.stopped, PolishTermination::time_limit);
}

TEST(Polish, GivesTheBestSoFarWhereALimitOfMemoryIsReachedInARound) {
  for (const bool is_refused : {false, true}) {
    Missed missed;
    const CancellationToken token;
    int calls = 0;
    missed.simulate = [&](const Eigen::VectorXd& parameters, const ProfileSamples& samples,
                          const Execution& execution) {
      if (calls++ == 2) {
        token.request(StopReason::memory);
        if (is_refused) throw std::bad_alloc();
      }
      execution.checkpoint(0, "simulation");
      return missed.displaced(parameters, samples);
    };
    const auto polished = missed.polished({.tolerance = 1e-9}, {token});
    EXPECT_EQ(polished.stopped, PolishTermination::memory);
    ASSERT_EQ(polished.rounds.size(), 3U);
    EXPECT_EQ(polished.rounds.back().reason, "A limit of memory was reached before the simulation had ended.");
    EXPECT_LE(*polished.target_error, *polished.rounds.front().target_error);
    EXPECT_FALSE(token.requested()) << "the report goes on";
  }
}

TEST(Polish, GivesTheBestSoFarWhereTheDeadlinePassesInARound) {
  for (const int last : {0, 2}) {
    Missed missed;
    const CancellationToken token;
    int calls = 0;
    missed.simulate = [&](const Eigen::VectorXd& parameters, const ProfileSamples& samples,
                          const Execution& execution) {
      if (calls++ == last) token.request(StopReason::deadline);
      execution.checkpoint(0, "simulation");
      return missed.displaced(parameters, samples);
    };
    const auto polished = missed.polished({.tolerance = 1e-9}, {token});
    EXPECT_EQ(polished.stopped, PolishTermination::deadline);
    ASSERT_EQ(polished.rounds.size(), static_cast<std::size_t>(last) + 1);
    EXPECT_EQ(polished.rounds.back().reason, "The deadline passed before the simulation had ended.");
    EXPECT_FALSE(polished.rounds.back().target_error || polished.rounds.back().accepted);
    EXPECT_EQ(polished.target_error.has_value(), last > 0);
    if (last == 0) {
      EXPECT_EQ(polished.parameters, missed.found.parameters);
    } else {
      EXPECT_LE(*polished.target_error, *polished.rounds.front().target_error);
    }
    EXPECT_EQ(polished.simulated[0].allFinite(), last > 0);
  }
}

TEST(Polish, StopsWhereItIsCancelled) {
  Missed missed;
  const CancellationToken token;
  token.request(StopReason::cancelled);
  expect_cancelled(StopReason::cancelled, [&] { missed.polished({}, {token}); });
}

TEST(Polish, GoesOnWithoutSimulatingAgain) {
  Missed at_once, in_parts;
  const PolishOptions options{.tolerance = 1e-4};
  const auto whole = at_once.polished(options);
  PolishOptions alone = options;
  alone.max_rounds = 0;
  const auto first = in_parts.polished(alone);
  const auto rest = polish(in_parts.test.space(), in_parts.problem, first, in_parts.simulate, options);
  EXPECT_EQ(in_parts.calls, at_once.calls);
  ASSERT_EQ(rest.rounds.size(), whole.rounds.size());
  EXPECT_EQ(rest.parameters, whole.parameters);
  EXPECT_EQ(rest.target_error, whole.target_error);
}

TEST(Polish, KeepsParametersThatAreFixed) {
  Missed missed;
  const double held = missed.found.parameters[1];
  missed.problem.fixed = {std::nullopt, held};
  for (const auto& round : missed.polished({.tolerance = 1e-9, .max_rounds = 6}).rounds)
    EXPECT_EQ(round.parameters[1], held);
  missed.problem.fixed = {missed.found.parameters[0], held};
  const auto nothing_free = missed.polished({.tolerance = 1e-9});
  EXPECT_EQ(nothing_free.stopped, PolishTermination::no_improvement);
  EXPECT_EQ(nothing_free.rounds.size(), 1U);
}

TEST(Polish, RefusesProposalsBeyondTheLimitsWithoutSimulatingThem) {
  Missed missed;
  auto space = missed.test.space();
  const auto& network = missed.test.model.network;
  space.measure = [&network](const Eigen::VectorXd& parameters) -> StructureMeasures {
    return {(parameters[0] - network.lower[0]) / (network.upper[0] - network.lower[0]), 10};
  };
  missed.problem.limits.relative_density.most = space.measure(missed.found.parameters).relative_density;
  int beyond = 0;
  const SimulateProfile watched = [&](const Eigen::VectorXd& parameters, const ProfileSamples& samples,
                                      const Execution& execution) {
    if (space.measure(parameters).relative_density > missed.problem.limits.relative_density.most) ++beyond;
    return missed.simulate(parameters, samples, execution);
  };
  const auto polished = polish(space, missed.problem, missed.found.parameters, watched, {.tolerance = 1e-6});
  EXPECT_EQ(beyond, 0);
  EXPECT_LE(space.measure(polished.parameters).relative_density, missed.problem.limits.relative_density.most);
  EXPECT_LT(*polished.target_error, *polished.rounds.front().target_error);
}

}  // namespace
}  // namespace supple::design
