#include "supple/design/polish.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <numbers>

#include "corrected_model.h"
#include "polish_rounds.h"
#include "polish_starts.h"
#include "supple/design/verdict.h"
#include "supple/design/verified_designs.h"
#include "supple/tiling/tiling_error.h"
#include "support/expect_error.h"
#include "support/test_calibration.h"
#include "test_space.h"
#include "trust_region_descent.h"

namespace supple::design {
namespace {

using supple::testing::expect_cancelled;
using supple::testing::expect_error;

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// Replaces a simulation: the network at slightly displaced parameters, times a factor. The deviation by this
/// simulation has its minima at other parameters than the deviation by the network.
class Displaced {
 public:
  explicit Displaced(const TestSpace& test, double factor = 1.05) : test_(test), factor_(factor) {}

  Eigen::VectorXd operator()(const Eigen::VectorXd& parameters, const ProfileSamples& samples) const {
    const Eigen::VectorXd width = test_.model.network.upper - test_.model.network.lower;
    const Eigen::VectorXd share = (parameters - test_.model.network.lower).cwiseQuotient(width);
    std::vector<double> moved(static_cast<std::size_t>(share.size()));
    for (Eigen::Index k = 0; k < share.size(); ++k)
      moved[static_cast<std::size_t>(k)] =
          test_.model.network.lower[k] + width[k] * (share[k] + 0.04 * std::sin(3 * share[k] + 1.0 * k));
    return factor_ * evaluate_profile(test_.model, test_.evaluator, moved, samples).y;
  }

  SimulateProfile counted(int& calls) const {
    return
        [this, &calls](const Eigen::VectorXd& parameters, const ProfileSamples& samples, const Execution& execution) {
          ++calls;
          execution.checkpoint(0, "simulation");
          return (*this)(parameters, samples);
        };
  }

 private:
  const TestSpace& test_;
  double factor_;
};

Target target_at(const TestSpace& test, const Displaced& simulation, std::vector<double> shares, Task task,
                 int points = 9) {
  Target target;
  target.task = task;
  target.direction = 0.3;
  target.strain = 0.1;
  target.samples = points;
  target.interpolation = numerics::Interpolation::linear;
  ProfileSamples samples{task, target.direction, target.strain, StrainMeasure::green, {}};
  for (int i = 0; i < points; ++i)
    samples.x.push_back(task == Task::stress_strain ? -0.1 + 0.3 * i / (points - 1) : std::numbers::pi * i / points);
  const auto at = test.at(std::move(shares));
  const Eigen::VectorXd parameters = Eigen::Map<const Eigen::VectorXd>(at.data(), static_cast<Eigen::Index>(at.size()));
  const auto y = simulation(parameters, samples);
  for (int i = 0; i < points; ++i) target.control_points.emplace_back(samples.x[static_cast<std::size_t>(i)], y[i]);
  return target;
}

/// A problem in which the network's design deviates by some per cent in the simulation.
struct Missed {
  explicit Missed(Task task = Task::stress_strain, int points = 9)
      : problem{{target_at(test, displaced, {0.4, 0.65}, task, points)}, {}, {}},
        found(find_design(test.space(), problem)) {}

  Polished polished(const PolishOptions& options = {}, const Execution& execution = {},
                    const OnPolishRound& on_round = {}) {
    return polish(test.space(), problem, found.parameters, simulate, options, execution, on_round);
  }

  TestSpace test{2, 1};
  Displaced displaced{test};
  DesignProblem problem;
  Design found;
  int calls = 0;
  SimulateProfile simulate = displaced.counted(calls);
};

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

TEST(DesignAt, TellsOfThePolishedDesignAsOfOneThatWasFound) {
  Missed missed;
  const auto polished = missed.polished();
  const auto design = design_at(missed.test.space(), missed.problem, polished.parameters, missed.found, {});
  EXPECT_EQ(design.parameters, polished.parameters);
  EXPECT_EQ(design.iterations, missed.found.iterations);
  EXPECT_EQ(design.starts, missed.found.starts);
  EXPECT_EQ(design.stopped, missed.found.stopped);
  EXPECT_EQ(design.profiles[0].initial, missed.found.profiles[0].initial);
  EXPECT_TRUE((design.profiles[0].lowest.array() <= design.profiles[0].achieved.array()).all());
  EXPECT_TRUE((design.profiles[0].highest.array() >= design.profiles[0].achieved.array()).all());
  EXPECT_NEAR(design.error.relative_rms, *design.profiles[0].target.relative_rms(design.profiles[0].achieved), 1e-9);
  EXPECT_GT(design.error.relative_rms, missed.found.error.relative_rms) << "the network finds its own design better";
}

TEST(DesignAt, HasTheErrorBarsOfTheProfile) {
  Missed missed(Task::stiffness);
  missed.test.model.calibration = supple::test::test_calibration(2);
  // The error bars depend on every feature of a state.
  for (auto& scale : missed.test.model.calibration->scales)
    scale.coefficients.segment(1, scale.mean.size()).setConstant(0.01);
  const Eigen::VectorXd& parameters = missed.found.parameters;
  const auto design = design_at(missed.test.space(), missed.problem, parameters, missed.found, {});
  const auto& shown = design.profiles[0];
  const std::vector<double> same(parameters.begin(), parameters.end());
  const auto profile = evaluate_profile(missed.test.model, missed.test.evaluator, same, shown.target.samples, 1e-12);
  ASSERT_EQ(shown.error_bar.size(), profile.error_bar.size());
  ASSERT_GT(shown.error_bar.size(), 0);
  EXPECT_LT((shown.error_bar - profile.error_bar).norm(), 1e-8 * profile.error_bar.norm());
  // Error bars of a stiffer material are longer in proportion, and so are those in the lower confidence bound of the
  // survey.
  DesignProblem stiffer = missed.problem;
  const double modulus = 3 * missed.test.model.provenance.youngs_modulus;
  stiffer.moduli = {{modulus, modulus}};
  const auto of_stiffer = design_at(missed.test.space(), stiffer, parameters, missed.found, {});
  EXPECT_LT((of_stiffer.profiles[0].error_bar - 3 * shown.error_bar).norm(), 1e-8 * shown.error_bar.norm());
  const Eigen::VectorXd all = FreeParameters::all_of(parameters, 0);
  const double bar = CorrectedModel(missed.test.space(), missed.problem, 1e-10).at(all).bar;
  EXPECT_NEAR(CorrectedModel(missed.test.space(), stiffer, 1e-10).at(all).bar, 3 * bar, 1e-8 * bar);
}

TEST(DesignAt, HoldsAllParametersAlsoWhereTheProblemFixesSome) {
  Missed missed;
  missed.problem.fixed = {std::nullopt, missed.found.parameters[1]};
  const auto polished = missed.polished();
  const auto design = design_at(missed.test.space(), missed.problem, polished.parameters, missed.found, {});
  EXPECT_EQ(design.parameters, polished.parameters);
}

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
