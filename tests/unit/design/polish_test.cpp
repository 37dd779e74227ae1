#include "supple/design/polish.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "displaced_simulation.h"
#include "polish_rounds.h"
#include "polish_starts.h"
#include "supple/design/verified_designs.h"
#include "supple/tiling/tiling_error.h"
#include "support/expect_error.h"
#include "trust_region_descent.h"

namespace supple::design {
namespace {

using supple::testing::expect_error;

class PolishTask : public ::testing::TestWithParam<Task> {};
INSTANTIATE_TEST_SUITE_P(Polish, PolishTask, ::testing::Values(Task::stress_strain, Task::stiffness, Task::poisson),
                         [](const auto& task) { return std::string(to_string(task.param)); });

TEST_P(PolishTask, ReachesTheTargetInTheSimulationThatTheNetworkMisses) {
  Missed missed(GetParam());
  const auto polished = missed.polished({.tolerance = 1e-4});
  ASSERT_TRUE(polished.rounds.front().target_error && polished.target_error);
  EXPECT_GT(*polished.rounds.front().target_error, 5e-3);
  EXPECT_LE(*polished.target_error, 1e-4);
  EXPECT_EQ(polished.stopped, PolishTermination::reached);
  EXPECT_LE(polished.rounds.size(), 8U);
  // The reported profile is that of the simulation at the returned parameters.
  const auto& samples = polished.targets[0].samples;
  EXPECT_EQ(polished.simulated[0], missed.displaced(polished.parameters, samples));
  EXPECT_EQ(*polished.target_error, *polished.targets[0].relative_rms(polished.simulated[0]));
  const std::vector<double> parameters(polished.parameters.begin(), polished.parameters.end());
  EXPECT_TRUE(polished.model[0].isApprox(
      evaluate_profile(missed.test.model, missed.test.evaluator, parameters, samples).y, 1e-8));
}

TEST(Polish, AcceptsOnlyWhatTheSimulationFindsBetter) {
  Missed missed;
  std::vector<PolishRound> told;
  const auto polished =
      missed.polished({.tolerance = 1e-4}, {}, [&](const PolishRound& round) { told.push_back(round); });
  ASSERT_EQ(told.size(), polished.rounds.size());
  EXPECT_EQ(missed.calls, static_cast<int>(told.size()));
  EXPECT_EQ(told.front().proposal, Proposal::search);
  EXPECT_EQ(told.front().parameters, missed.found.parameters);
  double best = std::numeric_limits<double>::infinity();
  Eigen::VectorXd accepted;
  for (const PolishRound& round : told) {
    EXPECT_EQ(round.accepted, *round.target_error < best);
    EXPECT_EQ(round.reason.empty(), round.accepted);
    EXPECT_GE(round.seconds, 0);
    if (!round.accepted) continue;
    best = *round.target_error;
    accepted = round.parameters;
  }
  EXPECT_EQ(polished.parameters, accepted) << "to the last bit";
  EXPECT_EQ(best, *polished.target_error);
}

TEST(Polish, KeepsTheSearchsDesignWhereNothingIsBetter) {
  Missed missed;
  const Eigen::VectorXd found = missed.found.parameters;
  // The profile is the target's own, plus an amount that grows with the distance from the design found.
  missed.simulate = [&](const Eigen::VectorXd& parameters, const ProfileSamples& samples, const Execution&) {
    const auto target = sample_target(missed.problem.targets[0]);
    EXPECT_EQ(samples.x, target.samples.x);
    return Eigen::VectorXd(target.y * (1.02 + 10 * (parameters - found).norm()));
  };
  const auto polished = missed.polished({.max_rounds = 60});
  EXPECT_EQ(polished.parameters, found);
  EXPECT_EQ(polished.stopped, PolishTermination::no_improvement);
  EXPECT_NEAR(*polished.target_error, 0.02, 1e-9);
  const auto tried = [&](Proposal proposal) {
    return std::any_of(polished.rounds.begin(), polished.rounds.end(),
                       [&](const PolishRound& round) { return round.proposal == proposal; });
  };
  EXPECT_TRUE(tried(Proposal::probe) && tried(Proposal::new_search)) << "before it gives up";
  for (std::size_t i = 1; i < polished.rounds.size(); ++i)
    EXPECT_EQ(polished.rounds[i].reason, "Its simulated deviation is not less.");
}

// The network knows nothing of this response: 10 % away from the target everywhere, except in a valley around one
// design.
TEST(Polish, SurveysTheBoxWhereTheNetworkIsOffEverywhere) {
  Missed missed;
  const TestSpace& test = missed.test;
  const auto at = test.at({0.85, 0.2});
  const Eigen::Vector2d valley(at[0], at[1]);
  const Eigen::VectorXd width = test.model.network.upper - test.model.network.lower;
  missed.simulate = [&](const Eigen::VectorXd& parameters, const ProfileSamples& samples, const Execution&) {
    const auto target = sample_target(missed.problem.targets[0]);
    EXPECT_EQ(samples.x, target.samples.x);
    const double away = (parameters - valley).cwiseQuotient(width).norm();
    return Eigen::VectorXd(target.y * (1 + std::min(0.1, 0.4 * away)));
  };
  const auto polished = missed.polished({.tolerance = 0.02, .max_rounds = 60});
  EXPECT_TRUE(std::ranges::any_of(
      polished.rounds, [](const PolishRound& round) { return round.proposal == Proposal::survey && round.accepted; }));
  EXPECT_EQ(polished.stopped, PolishTermination::reached);
  EXPECT_LE(*polished.target_error, 0.02);
}

TEST(Polish, EndsASurveyThatFindsNothing) {
  Missed missed;
  missed.simulate = [&](const Eigen::VectorXd&, const ProfileSamples&, const Execution&) {
    return Eigen::VectorXd(1.1 * sample_target(missed.problem.targets[0]).y);
  };
  const auto polished = missed.polished({.max_rounds = 100});
  EXPECT_EQ(polished.stopped, PolishTermination::no_improvement);
  EXPECT_EQ(std::ranges::count(polished.rounds, Proposal::survey, &PolishRound::proposal), 8);
}

TEST(Polish, GoesAroundParametersThatHaveNoStructure) {
  Missed free;
  const Eigen::VectorXd first_step = free.polished({.tolerance = 1e-3}).rounds.at(1).parameters;
  Missed missed;
  missed.simulate = [&](const Eigen::VectorXd& parameters, const ProfileSamples& samples, const Execution&) {
    if ((parameters - first_step).norm() < 1e-9)
      throw tiling::TilingError("tiling.cell_too_small", "There is no such tile.");
    return missed.displaced(parameters, samples);
  };
  const auto polished = missed.polished({.tolerance = 1e-3});
  EXPECT_EQ(polished.stopped, PolishTermination::reached);
  EXPECT_EQ(polished.rounds.at(1).reason, "There is no such tile.");
  EXPECT_FALSE(polished.rounds.at(1).target_error || polished.rounds.at(1).accepted);
}

TEST(Polish, RefusesDesignsThatCannotBeBuiltWithTheirReason) {
  Missed missed;
  const Eigen::VectorXd found = missed.found.parameters;
  missed.simulate = [&](const Eigen::VectorXd& parameters, const ProfileSamples& samples, const Execution&) {
    if (parameters != found) throw tiling::TilingError("tiling.cell_too_small", "There is no such tile.");
    return missed.displaced(parameters, samples);
  };
  const auto polished = missed.polished();
  EXPECT_EQ(polished.parameters, found);
  EXPECT_EQ(polished.stopped, PolishTermination::no_improvement);
  ASSERT_GT(polished.rounds.size(), 3U);
  for (std::size_t i = 1; i < polished.rounds.size(); ++i) {
    EXPECT_FALSE(polished.rounds[i].target_error);
    EXPECT_EQ(polished.rounds[i].reason, "There is no such tile.");
  }
}

TEST(Polish, ThrowsWhatIsNoMatterOfTheParameters) {
  Missed missed;
  missed.simulate = [](const Eigen::VectorXd&, const ProfileSamples&, const Execution&) -> Eigen::VectorXd {
    throw Error("numerics.out_of_memory", "No memory.");
  };
  expect_error("numerics.out_of_memory", [&] { missed.polished(); });
}

TEST(Polish, SaysWhereNoDesignIsSimulatedEverywhere) {
  Missed missed;
  missed.simulate = [&](const Eigen::VectorXd& parameters, const ProfileSamples& samples, const Execution&) {
    Eigen::VectorXd y = missed.displaced(parameters, samples);
    y[3] = missing;
    return y;
  };
  const auto polished = missed.polished();
  EXPECT_EQ(polished.stopped, PolishTermination::not_simulated);
  EXPECT_FALSE(polished.target_error);
  EXPECT_EQ(polished.parameters, missed.found.parameters);
  for (const PolishRound& round : polished.rounds) {
    EXPECT_FALSE(round.accepted || round.target_error);
    EXPECT_EQ(round.reason, "The simulation does not reach every sample.");
  }
  EXPECT_EQ(missed.polished({.max_rounds = 0}).stopped, PolishTermination::not_simulated);
  EXPECT_TRUE(std::isnan(polished.simulated[0][3]) && std::isfinite(polished.simulated[0][2]))
      << "what there is is told";
}

TEST(Polish, StartsElsewhereWhereTheDesignFoundCannotBeSimulated) {
  Missed missed;
  const Eigen::VectorXd elsewhere = missed.test.model.network.lower;
  missed.simulate = [&](const Eigen::VectorXd& parameters, const ProfileSamples& samples, const Execution&) {
    if (parameters == elsewhere) throw tiling::TilingError("tiling.cell_too_small", "There is no such tile.");
    return missed.displaced(parameters, samples);
  };
  const auto polished = polish(missed.test.space(), missed.problem, elsewhere, missed.simulate, {.tolerance = 1e-3});
  EXPECT_EQ(polished.stopped, PolishTermination::reached);
  EXPECT_FALSE(polished.rounds[0].accepted);
  EXPECT_EQ(polished.rounds[1].proposal, Proposal::new_search);
  EXPECT_TRUE(polished.rounds[1].accepted);
}

TEST(Polish, SimulatesSamplesOfTheTargetWhereItCan) {
  Missed missed(Task::stiffness, 50);
  const auto polished = missed.polished({.samples = 12, .max_rounds = 0});
  const auto wanted = sample_target(missed.problem.targets[0]).samples.x;
  EXPECT_EQ(polished.targets[0].samples.x.size(), 10U) << "the largest divisor of 50 up to 12";
  for (const double x : polished.targets[0].samples.x)
    EXPECT_TRUE(std::any_of(wanted.begin(), wanted.end(), [&](double y) { return std::abs(x - y) < 1e-12; })) << x;
  Missed curve(Task::stress_strain, 31);
  EXPECT_EQ(curve.polished({.samples = 12, .max_rounds = 0}).targets[0].samples.x.size(), 11U);
  Missed prime(Task::stiffness, 53);
  EXPECT_EQ(prime.polished({.samples = 12, .max_rounds = 0}).targets[0].samples.x.size(), 12U);
  EXPECT_EQ(curve.polished({.samples = 99, .max_rounds = 0}).targets[0].samples.x.size(), 31U);
}

TEST(Polish, CountsTheWeightsOfTargetsAndTheirBands) {
  Missed missed;
  Target second = target_at(missed.test, missed.displaced, {0.4, 0.65}, Task::stiffness);
  for (auto& point : second.control_points) point[1] *= 1.2;
  second.weight = 3;
  missed.problem.targets.push_back(second);
  const auto polished = missed.polished({.max_rounds = 0});
  const double first = *polished.targets[0].relative_rms(polished.simulated[0]);
  const double other = *polished.targets[1].relative_rms(polished.simulated[1]);
  EXPECT_GT(other, 0.1);
  EXPECT_NEAR(*polished.target_error, std::sqrt((first * first + 3 * other * other) / 4), 1e-12);
  missed.problem.targets[1].bands.assign(second.control_points.size(), 1e3);
  EXPECT_NEAR(*missed.polished({.max_rounds = 0}).target_error, first / 2, 1e-12);
}

TEST(TrustRegionDescent, ReachesTheTargetFromTheDesignOfTheSearch) {
  Missed missed;
  const PolishOptions options{.tolerance = 1e-4};
  const Execution execution;
  const OnPolishRound on_round;
  PolishRounds rounds(missed.test.space(), missed.problem, missed.simulate, options, execution, on_round);
  const auto found = rounds.simulate_found(FreeParameters::all_of(missed.found.parameters, 0));
  EXPECT_GT(found.deviation, 5e-3);
  EXPECT_EQ(TrustRegionDescent(rounds, found).run(), PolishTermination::reached);
  EXPECT_LE(rounds.best().deviation, 1e-4);
  EXPECT_EQ(rounds.count(), missed.calls);
  EXPECT_EQ(rounds.result(PolishTermination::reached).rounds.size(), rounds.tried().size());
}

TEST(OtherStarts, AreMinimaThatWereNotSimulatedAndEndWithHalfOfTheRounds) {
  Missed missed;
  const PolishOptions options{.max_rounds = 4};
  const Execution execution;
  const OnPolishRound on_round;
  const DesignSpace space = missed.test.space();
  PolishRounds rounds(space, missed.problem, missed.simulate, options, execution, on_round);
  rounds.simulate_found(FreeParameters::all_of(missed.found.parameters, 0));
  OtherStarts starts(space, rounds);
  std::vector<Eigen::VectorXd> given;
  while (const auto start = starts.next()) {
    EXPECT_GT(distance_to_nearest(*start, rounds.tried()), 1e-3);
    EXPECT_GT(distance_to_nearest(*start, given), 0.01) << "each minimum once";
    given.push_back(*start);
  }
  EXPECT_LE(given.size(), 3U);
  OtherStarts late(space, rounds);
  while (rounds.count() <= 2) rounds.simulate(Proposal::survey, Eigen::Vector2d(0.5, 0.5));
  EXPECT_FALSE(late.next()) << "the other half of the rounds is for the survey";
}

/// The simulation is stiffer than the network by the same factor everywhere, so that another modulus alone corrects it.
TEST(Polish, CorrectsTheModulusByTheSimulation) {
  const TestSpace test(2, 1);
  const double model_modulus = test.model.provenance.youngs_modulus;
  int calls = 0;
  const SimulateProfile stiffer = [&](const Eigen::VectorXd& parameters, const ProfileSamples& samples,
                                      const Execution&) -> Eigen::VectorXd {
    ++calls;
    const std::vector<double> p(parameters.begin(), parameters.end());
    return (samples.task == Task::poisson ? 1 : 1.25) * evaluate_profile(test.model, test.evaluator, p, samples).y;
  };
  const Displaced exact(test, 3);
  DesignProblem problem{{target_at(test, exact, {0.4, 0.65}, Task::stiffness)}, {}, {}};
  problem.moduli = {{model_modulus, 10 * model_modulus}};
  const auto found = find_design(test.space(), problem);
  ASSERT_LT(found.error.relative_rms, 1e-3);
  const auto polished = polish(test.space(), problem, found.parameters, stiffer, {});
  EXPECT_EQ(calls, 1);
  EXPECT_LT(*polished.target_error, 1e-3);
  EXPECT_NEAR(polished.youngs_modulus, found.youngs_modulus / 1.25, 1e-3 * found.youngs_modulus);
  EXPECT_DOUBLE_EQ(polished.stress_factor, polished.youngs_modulus / model_modulus);
  // Profiles are at the reported modulus.
  EXPECT_EQ(*polished.target_error, *polished.targets[0].relative_rms(polished.simulated[0]));
  EXPECT_LT((polished.simulated[0] - 1.25 * polished.model[0]).norm(), 1e-9 * polished.simulated[0].norm());

  // The same by search_designs, with polish and without. Without polish the modulus of the search is kept.
  const std::vector<DesignSpace> spaces{test.space()};
  const std::vector<FamilySimulation> simulations{{stiffer, stiffer}};
  DesignSearch search{problem};
  search.verification = VerificationPlan{};
  const auto corrected = search_designs(spaces, simulations, search);
  const Design& design = corrected.ranking.front().design;
  EXPECT_TRUE(design.reached);
  EXPECT_EQ(design.youngs_modulus, corrected.polished->youngs_modulus);
  EXPECT_NEAR(*corrected.discretization_error[0], 0, 1e-12);
  EXPECT_GT(design.error.relative_rms, 0.1) << "the network's own deviation at the simulation's modulus";
  search.verification->polish = Switch::off;
  const auto kept = search_designs(spaces, simulations, search);
  EXPECT_EQ(kept.ranking.front().design.youngs_modulus, found.youngs_modulus);
  EXPECT_NEAR(*kept.polished->target_error, 0.25, 0.01);
}

TEST(Polish, GoesOnWithAnotherModulusWhereItStopped) {
  Missed missed(Task::stiffness);
  const double model_modulus = missed.test.model.provenance.youngs_modulus;
  for (auto& point : missed.problem.targets[0].control_points) point[1] *= 2;
  missed.problem.moduli = {{1.5 * model_modulus, 3 * model_modulus}};
  const auto whole = missed.polished({.tolerance = 1e-5});
  const auto begun = missed.polished({.tolerance = 1e-5, .max_rounds = 0});
  const auto gone_on = polish(missed.test.space(), missed.problem, begun, missed.simulate, {.tolerance = 1e-5});
  EXPECT_LE(*whole.target_error, 1e-5);
  EXPECT_GT(begun.stress_factor, 1.5);
  EXPECT_GT(whole.rounds.size(), 1U);
  EXPECT_TRUE(gone_on.parameters.isApprox(whole.parameters, 1e-9));
  EXPECT_NEAR(gone_on.youngs_modulus, whole.youngs_modulus, 1e-9 * model_modulus);
}

TEST(Polish, TurnsADesignByWhatTheSimulationSays) {
  Missed missed(Task::stiffness);
  // A simulation of a structure that is turned by a small angle.
  const SimulateProfile askew = [&](const Eigen::VectorXd& parameters, ProfileSamples samples, const Execution&) {
    samples.orientation += 0.15;
    return missed.displaced(parameters, samples);
  };
  missed.problem.orientation = {-0.5, 0.5};
  missed.found = find_design(missed.test.space(), missed.problem);
  const OrientedParameters found(missed.found.parameters, missed.found.orientation);
  const auto polished = polish(missed.test.space(), missed.problem, found, askew, {.tolerance = 1e-4});
  EXPECT_GT(*polished.rounds.front().target_error, 5e-3);
  EXPECT_LE(*polished.target_error, 1e-4);
  EXPECT_EQ(polished.simulated[0], askew(polished.parameters, polished.targets[0].samples, {}));
  EXPECT_EQ(polished.targets[0].samples.orientation, polished.orientation);
  EXPECT_EQ(polished.rounds.front().orientation, missed.found.orientation);
  const auto design = design_at(missed.test.space(), missed.problem,
                                OrientedParameters(polished.parameters, polished.orientation), missed.found, {});
  EXPECT_EQ(design.orientation, polished.orientation);
  const auto begun = polish(missed.test.space(), missed.problem, found, askew, {.tolerance = 1e-4, .max_rounds = 0});
  const auto gone_on = polish(missed.test.space(), missed.problem, begun, askew, {.tolerance = 1e-4});
  EXPECT_EQ(gone_on.orientation, polished.orientation);
}

}  // namespace
}  // namespace supple::design
