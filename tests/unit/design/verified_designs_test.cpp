#include "supple/design/verified_designs.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "displaced_simulation.h"
#include "supple/design/verdict.h"
#include "supple/tiling/tiling_error.h"
#include "support/expect_error.h"

namespace supple::design {
namespace {

using supple::testing::expect_cancelled;

/// Two families for one target. The network of the first family meets it, and the simulation of the second does.
struct TwoFamilies {
  TwoFamilies() {
    problem.targets = {target_at(second, second_displaced, {0.4, 0.65}, Task::stress_strain)};
    ranking = find_designs(spaces, problem);
  }
  VerifiedDesigns verified(const VerificationPlan& plan, const Execution& execution = {}) {
    return verify_designs(spaces, simulations, problem, ranking, {}, plan, execution,
                          [&](const Design& design, const PolishRound&) { told.push_back(design.space); });
  }

  TestSpace first{2, 1};
  TestSpace second{2, 1};
  Displaced first_displaced{first, 1.5};
  Displaced second_displaced{second};
  int first_calls = 0, second_calls = 0;
  std::vector<DesignSpace> spaces{first.space(), second.space()};
  std::vector<FamilySimulation> simulations{{first_displaced.counted(first_calls), {}},
                                            {second_displaced.counted(second_calls), {}}};
  DesignProblem problem;
  std::vector<Design> ranking;
  std::vector<std::size_t> told;
};

TEST(VerifyDesigns, GivesAnEmptyAnswerToAnEmptyRanking) {
  const TwoFamilies families;
  const auto nothing = verify_designs(families.spaces, families.simulations, families.problem, {}, {}, {});
  EXPECT_TRUE(nothing.ranking.empty());
  EXPECT_FALSE(nothing.polished);
}

TEST(SearchDesigns, SimulatesWhatItFindsWhereThereIsAPlanForIt) {
  TwoFamilies families;
  families.first_calls = families.second_calls = 0;
  int searched = 0;
  const SearchObserver observer{
      [&](const DesignProgress&) { ++searched; },
      [&](const Design& design, const PolishRound&) { families.told.push_back(design.space); }};
  CostLedger bill;
  const auto found = search_designs(families.spaces, families.simulations, {families.problem, {}, VerificationPlan{}},
                                    {.cost = &bill}, observer);
  const auto apart = families.verified({});
  ASSERT_TRUE(found.polished);
  EXPECT_EQ(found.polished->parameters, apart.polished->parameters);
  EXPECT_EQ(found.ranking.front().design.space, 1U);
  EXPECT_GT(searched, 0);
  EXPECT_FALSE(families.told.empty());
}

TEST(SearchDesigns, SimulatesNothingWithoutAPlan) {
  TwoFamilies families;
  CostLedger bill;
  const auto found = search_designs(families.spaces, {}, {families.problem}, {.cost = &bill});
  EXPECT_FALSE(found.polished);
  EXPECT_TRUE(found.discretization_error.empty());
  ASSERT_EQ(found.ranking.size(), 2U);
  EXPECT_EQ(found.ranking[0].design.parameters, families.ranking[0].parameters);
  EXPECT_FALSE(found.ranking[0].target_error);
  EXPECT_EQ(families.first_calls + families.second_calls, 0);
  int told = 0;
  for (const auto& effect : bill.effects())
    if (effect.name == "verification" || effect.name == "polish") told += effect.ran ? 100 : 1;
  EXPECT_EQ(told, 2) << "both are on the bill as not run";
}

TEST(VerifyDesigns, RanksFamiliesByTheirSimulation) {
  TwoFamilies families;
  ASSERT_EQ(families.ranking.front().space, 0U) << "the same network twice: the first comes first";
  CostLedger bill;
  const auto verified = families.verified({}, {.cost = &bill});
  EXPECT_EQ(verified.ranking.front().design.space, 1U);
  EXPECT_EQ(families.first_calls, 1);
  ASSERT_TRUE(verified.ranking[0].target_error && verified.ranking[1].target_error);
  EXPECT_LT(*verified.ranking[0].target_error, *verified.ranking[1].target_error);
  EXPECT_EQ(verified.polished->stopped, PolishTermination::reached);
  EXPECT_EQ(verified.ranking.front().design.parameters, verified.polished->parameters);
  EXPECT_EQ(*verified.ranking.front().target_error, *verified.polished->target_error);
  EXPECT_EQ(families.told.size(), static_cast<std::size_t>(families.first_calls + families.second_calls));
  ASSERT_EQ(bill.effects().size(), 1U);
  EXPECT_TRUE(bill.effects()[0].ran);
  EXPECT_EQ(bill.effects()[0].count, families.second_calls - 1);
}

TEST(VerifyDesigns, SimulateOnlyTheFirstWherePolishingIsOff) {
  TwoFamilies families;
  CostLedger bill;
  const auto verified = families.verified({.polish = Switch::off}, {.cost = &bill});
  EXPECT_EQ(verified.ranking.front().design.space, 0U);
  EXPECT_EQ(families.first_calls, 1);
  EXPECT_EQ(families.second_calls, 0);
  EXPECT_FALSE(verified.ranking[1].target_error);
  EXPECT_EQ(verified.ranking.front().design.parameters, families.ranking.front().parameters);
  EXPECT_FALSE(bill.effects()[0].ran);
  EXPECT_EQ(bill.effects()[0].why, "the request turns it off");
}

TEST(VerifyDesigns, LeaveFamiliesBeyondThePlanBehind) {
  TwoFamilies families;
  const auto verified = families.verified({.families = 1});
  EXPECT_EQ(verified.ranking.front().design.space, 0U);
  EXPECT_EQ(families.second_calls, 0);
  EXPECT_EQ(verified.ranking.size(), 2U);
}

TEST(VerifyDesigns, LetTheSimulationSayWhetherTheTargetIsReached) {
  TwoFamilies families;
  const auto polished = families.verified({});
  const Design& corrected = polished.ranking.front().design;
  EXPECT_TRUE(corrected.reached);
  EXPECT_EQ(corrected.message.find("No design"), std::string::npos) << corrected.message;
  ASSERT_TRUE(families.ranking.front().reached) << "by the network";
  const auto plain = families.verified({.polish = Switch::off});
  const Design& wrong = plain.ranking.front().design;
  EXPECT_FALSE(wrong.reached);
  EXPECT_EQ(wrong.message.rfind("The simulated structure does not reach the target", 0), 0U) << wrong.message;
}

TEST(VerifyDesigns, SayByHowMuchACoarserMeshChangesTheAnswer) {
  TwoFamilies families;
  EXPECT_FALSE(families.verified({}).discretization_error.at(0)) << "nobody asks";
  Eigen::VectorXd asked_for;
  families.simulations[0].coarser = [](const auto&, const auto&, const auto&) -> Eigen::VectorXd {
    throw Error("internal", "The other family's structure.");
  };
  families.simulations[1].coarser = [&](const Eigen::VectorXd& parameters, const ProfileSamples& samples,
                                        const Execution& execution) -> Eigen::VectorXd {
    asked_for = parameters;
    return 1.25 * families.simulations[1].simulate(parameters, samples, execution);
  };
  const auto verified = families.verified({});
  ASSERT_EQ(verified.discretization_error.size(), 1U);
  EXPECT_NEAR(verified.discretization_error[0].value(), 0.25, 1e-12);
  EXPECT_EQ(asked_for, verified.polished->parameters);
}

TEST(VerifyDesigns, StandWithoutTheEstimateThatFailsUnlessTheyAreCancelled) {
  TwoFamilies families;
  families.simulations[1].coarser = [](const auto&, const auto&, const auto&) -> Eigen::VectorXd {
    throw tiling::TilingError("tiling.meshing_failed", "No estimate.");
  };
  EXPECT_FALSE(families.verified({}).discretization_error.at(0));
  families.simulations[1].coarser = [](const auto&, const ProfileSamples& samples, const auto&) -> Eigen::VectorXd {
    return Eigen::VectorXd::Constant(static_cast<Eigen::Index>(samples.x.size()),
                                     std::numeric_limits<double>::quiet_NaN());
  };
  EXPECT_FALSE(families.verified({}).discretization_error.at(0));
  for (const StopReason reason : {StopReason::cancelled, StopReason::shutdown, StopReason::superseded}) {
    families.simulations[1].coarser = [reason](const auto&, const auto&, const auto&) -> Eigen::VectorXd {
      throw Cancelled(reason);
    };
    expect_cancelled(reason, [&] { families.verified({}); });
  }
}

/// The targets are out of reach, so that designs end at the bounds, and polishing moves them along these.
TEST(VerifyDesigns, SayWhichParametersAreAtTheirBoundsAfterAPolishToo) {
  int moved_and_at_bounds = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
    for (const double factor : {0.4, 1.6, 3.0}) {
      const TestSpace test(2, seed);
      const Displaced displaced(test);
      int calls = 0;
      const std::vector<DesignSpace> spaces{test.space()};
      const std::vector<FamilySimulation> simulations{{displaced.counted(calls), {}}};
      DesignProblem problem;
      problem.targets = {target_at(test, displaced, {0.4, 0.65}, Task::stress_strain)};
      for (auto& point : problem.targets[0].control_points) point[1] *= factor;
      const auto ranking = find_designs(spaces, problem);
      const auto verified = verify_designs(spaces, simulations, problem, ranking, {}, {.options = {.max_rounds = 8}});
      const Design& best = verified.ranking[0].design;
      if (best.reached || best.parameters == ranking[0].parameters) continue;
      const neural::Network& network = test.model.network;
      for (Eigen::Index k = 0; k < best.parameters.size(); ++k) {
        const bool is_low = best.parameters[k] == network.lower[k];
        if (!is_low && best.parameters[k] != network.upper[k]) continue;
        ++moved_and_at_bounds;
        const std::string sentence =
            "Parameter " + std::to_string(k + 1) + " is at its " + (is_low ? "lower" : "upper") + " bound.";
        EXPECT_NE(best.message.find(sentence), std::string::npos) << best.message;
      }
    }
  }
  EXPECT_GT(moved_and_at_bounds, 0);
}

TEST(VerifyDesigns, SayThatTheModulusIsAtItsLimitWhereOnlyTheSimulationMisses) {
  const TestSpace test(2, 1);
  const Displaced displaced(test, 3);
  const double modulus = test.model.provenance.youngs_modulus;
  int calls = 0;
  const std::vector<DesignSpace> spaces{test.space()};
  const std::vector<FamilySimulation> simulations{{displaced.counted(calls), {}}};
  DesignProblem problem;
  problem.targets = {target_at(test, Displaced(test, 1), {0.4, 0.65}, Task::stress_strain)};
  problem.moduli = {{0.9 * modulus, 1.1 * modulus}};
  auto ranking = find_designs(spaces, problem);
  ASSERT_TRUE(ranking[0].reached);
  const auto verified =
      verify_designs(spaces, simulations, problem, std::move(ranking), {}, {.options = {.max_rounds = 0}});
  const Design& best = verified.ranking[0].design;
  EXPECT_FALSE(best.reached);
  EXPECT_DOUBLE_EQ(best.youngs_modulus, 0.9 * modulus);
  EXPECT_TRUE(best.message.ends_with(" Young's modulus is at its lower limit.")) << best.message;
}

TEST(VerifyDesigns, GiveTheBestSoFarAtTheDeadline) {
  TwoFamilies families;
  const CancellationToken token;
  token.request(StopReason::deadline);
  const auto verified = families.verified({}, {.cancellation = token});
  EXPECT_EQ(verified.polished->stopped, PolishTermination::deadline);
  EXPECT_EQ(verified.ranking.size(), 2U);
  EXPECT_FALSE(verified.ranking[0].target_error);
  EXPECT_FALSE(verified.discretization_error.at(0));
}

TEST(VerifyDesigns, AnswerWithTheDesignOfTheModelIfItsSimulationIsStopped) {
  for (const StopReason reason : {StopReason::deadline, StopReason::memory}) {
    for (const Switch polish : {Switch::off, Switch::automatic}) {
      TwoFamilies families;
      const CancellationToken token;
      token.request(reason);
      const auto verified = families.verified({.polish = polish}, {.cancellation = token});
      const Design& best = verified.ranking.at(0).design;
      EXPECT_EQ(best.parameters, families.ranking[0].parameters);
      EXPECT_EQ(best.youngs_modulus, families.ranking[0].youngs_modulus);
      EXPECT_FALSE(is_simulated(*verified.polished));
      EXPECT_EQ(best.message.rfind(reason == StopReason::deadline ? "The deadline passed before the design"
                                                                  : "A limit of memory was reached before the design",
                                   0),
                0U)
          << best.message;
      EXPECT_EQ(judge(evidence_of(best, &*verified.polished)).source, VerdictSource::model);
    }
  }
}

}  // namespace
}  // namespace supple::design
