#include "supple/design/ways_out.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "support/expect_error.h"
#include "test_space.h"

namespace supple::design {
namespace {

using Change = WayOut::Change;
using supple::testing::expect_cancelled;

/// Seconds that no test needs, so that a busy machine changes nothing.
constexpr double ample_seconds = 600;

/// The response of a structure that is turned by `orientation`, times `factor`. It has 12 control points, or 21 over
/// strains from `least` to `most`.
struct Response {
  Task task = Task::stiffness;
  double orientation = 0;
  double factor = 1;
  double least = 0;
  double most = 0.2;
};

Target response_target(const TestSpace& test, const std::vector<double>& parameters, const Response& response) {
  Target target;
  target.task = response.task;
  target.direction = 0.3;
  target.strain = 0.1;
  target.interpolation = numerics::Interpolation::linear;
  const bool over_strain = response.task == Task::stress_strain;
  const int points = over_strain ? 21 : 12;
  ProfileSamples samples{response.task,       target.direction, target.strain, StrainMeasure::green, {},
                         response.orientation};
  for (int i = 0; i < points; ++i)
    samples.x.push_back(over_strain ? response.least + (response.most - response.least) * i / (points - 1)
                                    : std::numbers::pi * i / points);
  const auto profile = evaluate_profile(test.model, test.evaluator, parameters, samples);
  for (int i = 0; i < points; ++i)
    target.control_points.emplace_back(samples.x[static_cast<std::size_t>(i)], response.factor * profile.y[i]);
  target.samples = points;
  return target;
}

/// The problem of a design whose parameters are given: the search finds nothing but what a way out changes.
DesignProblem held_problem(const std::vector<double>& parameters, Target target) {
  DesignProblem problem{{std::move(target)}, {}, {}};
  problem.fixed.assign(parameters.begin(), parameters.end());
  return problem;
}

struct Answer {
  Design design;
  std::vector<WayOut> ways;
  CostLedger bill;

  const WayOut* way(Change change) const {
    const auto found = std::find_if(ways.begin(), ways.end(), [&](const WayOut& way) { return way.change == change; });
    return found == ways.end() ? nullptr : &*found;
  }
  CostLedger::Effect effect() const {
    for (const auto& effect : bill.effects())
      if (effect.name == "ways_out") return effect;
    ADD_FAILURE() << "the bill does not name ways_out";
    return {};
  }
};

Answer ways_out_of(const TestSpace& test, const DesignProblem& problem, std::span<const DesignSpace> others = {},
                   double seconds = ample_seconds) {
  const DesignOptions options;
  Answer answer;
  answer.design = find_design(test.space(), problem, options);
  answer.ways =
      find_ways_out({test.space(), others, problem, options, seconds}, answer.design, {}, {.cost = &answer.bill});
  return answer;
}

bool is_missed(const Answer& answer) { return answer.design.error.relative_rms > 0.1; }

bool begins_with(const WayOut& way, const std::string& words) { return way.sentence.rfind(words, 0) == 0; }

TEST(WaysOut, TurnADesignThatMeetsTheTargetOnlyTurned) {
  int missed = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
    const TestSpace test(2, seed);
    const auto parameters = test.at({0.37, 0.72});
    const auto answer =
        ways_out_of(test, held_problem(parameters, response_target(test, parameters, {.orientation = 1.1})));
    if (!is_missed(answer)) continue;
    ++missed;
    const WayOut* way = answer.way(Change::turn);
    ASSERT_TRUE(way) << seed;
    EXPECT_LT(way->deviation, 1e-2);
    EXPECT_TRUE(begins_with(*way, "Turn the tiling by ")) << way->sentence;
    EXPECT_NE(way->sentence.find(" % by the model."), std::string::npos) << way->sentence;
    EXPECT_GE(way->orientation, 0);
    EXPECT_LT(way->orientation, std::numbers::pi);
    EXPECT_EQ(way->youngs_modulus, answer.design.youngs_modulus);
    EXPECT_FALSE(way->other || way->range);
    EXPECT_FALSE(answer.way(Change::shorten)) << "directions have no range of strains";
    EXPECT_TRUE(answer.effect().ran);
    EXPECT_EQ(answer.effect().why, "the target is missed");
  }
  EXPECT_GT(missed, 0);
}

TEST(WaysOut, TurnTheShorterWayFromTheOrientationOfTheDesign) {
  int missed = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
    const TestSpace test(2, seed);
    const auto parameters = test.at({0.37, 0.72});
    auto problem = held_problem(parameters, response_target(test, parameters, {.orientation = 0.2}));
    problem.orientation = {0.9, 0.9};
    const auto answer = ways_out_of(test, problem);
    if (!is_missed(answer)) continue;
    const WayOut* way = answer.way(Change::turn);
    ASSERT_TRUE(way) << seed;
    if (std::abs(way->orientation - 0.2) > 3e-3) continue;  // Another orientation does the same.
    ++missed;
    EXPECT_TRUE(begins_with(*way, "Turn the tiling by 40 degrees clockwise: ")) << way->sentence;
  }
  EXPECT_GT(missed, 0);
}

TEST(WaysOut, NameTheMaterialOfATargetThatIsTooStiff) {
  const TestSpace test(2, 1);
  const auto parameters = test.at({0.37, 0.72});
  const auto stiff = response_target(test, parameters, {.task = Task::stress_strain, .factor = 3});
  const auto answer = ways_out_of(test, held_problem(parameters, stiff));
  const double modulus = test.model.provenance.youngs_modulus;
  const WayOut* way = answer.way(Change::modulus);
  ASSERT_TRUE(way);
  EXPECT_NEAR(way->youngs_modulus, 3 * modulus, 1e-6 * modulus);
  EXPECT_LT(way->deviation, 1e-6);
  EXPECT_TRUE(way->sentence.ends_with(": less than 0.01 % instead of 67 % by the model.")) << way->sentence;
  EXPECT_TRUE(begins_with(*way, "Use a material of ")) << way->sentence;
  EXPECT_EQ(answer.ways.front().change, Change::modulus) << "the best one comes first";
  EXPECT_FALSE(answer.way(Change::turn_and_modulus)) << "one of them suffices";
}

TEST(WaysOut, DoNotNameAnotherMaterialWhereTheSearchHasFoundTheBestOne) {
  const TestSpace test(2, 1);
  const auto parameters = test.at({0.37, 0.72});
  auto target = response_target(test, parameters, {.task = Task::stress_strain});
  for (std::size_t i = 1; i < target.control_points.size(); i += 2) target.control_points[i][1] *= 3;
  auto problem = held_problem(parameters, target);
  problem.moduli = {{0.01 * test.model.provenance.youngs_modulus, 100 * test.model.provenance.youngs_modulus}};
  const auto answer = ways_out_of(test, problem);
  ASSERT_TRUE(is_missed(answer));
  EXPECT_FALSE(answer.way(Change::modulus) || answer.way(Change::turn_and_modulus));
}

TEST(WaysOut, TurnAndNameAMaterialWhereNeitherSufficesAlone) {
  int needed = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
    const TestSpace test(2, seed);
    const auto parameters = test.at({0.37, 0.72});
    const auto target = response_target(test, parameters, {.orientation = 1.1, .factor = 3});
    const auto answer = ways_out_of(test, held_problem(parameters, target));
    const auto suffices = [&](Change change) { return answer.way(change) && answer.way(change)->deviation <= 0.05; };
    if (suffices(Change::turn) || suffices(Change::modulus)) continue;
    ++needed;
    const WayOut* way = answer.way(Change::turn_and_modulus);
    ASSERT_TRUE(way) << seed;
    EXPECT_LT(way->deviation, 1e-2);
    EXPECT_NE(way->sentence.find(" and use a material of "), std::string::npos) << way->sentence;
  }
  EXPECT_GT(needed, 0);
}

TEST(WaysOut, FindTheLongestPartOfTheRangeThatIsReached) {
  const TestSpace test(2, 1);
  const auto parameters = test.at({0.37, 0.72});
  const auto shortened_to = [&](double least, double most, double reach) {
    auto target = response_target(test, parameters, {.task = Task::stress_strain, .least = least, .most = most});
    for (auto& point : target.control_points)
      if (std::abs(point[0]) > reach + 1e-9) point[1] *= 3;
    const auto answer = ways_out_of(test, held_problem(parameters, target));
    const WayOut* way = answer.way(Change::shorten);
    EXPECT_TRUE(way);
    if (!way || !way->range) return Range{0, 0};
    EXPECT_LE(way->deviation, 0.05);
    EXPECT_TRUE(begins_with(*way, "Shorten the target to Green strains from ")) << way->sentence;
    return *way->range;
  };
  const Range tension = shortened_to(0, 0.2, 0.1);
  EXPECT_NEAR(tension.least, 0, 1e-12);
  EXPECT_NEAR(tension.most, 0.1, 0.011);
  const Range compression = shortened_to(-0.16, 0, 0.08);
  EXPECT_NEAR(compression.least, -0.08, 0.009);
  EXPECT_NEAR(compression.most, 0, 1e-12);
  const Range both = shortened_to(-0.1, 0.1, 0.05);
  EXPECT_NEAR(both.least, -0.05, 0.011);
  EXPECT_NEAR(both.most, 0.05, 0.011);
}

TEST(WaysOut, DoNotShortenATargetOfWhichHardlyAnythingIsReached) {
  const TestSpace test(2, 1);
  const auto parameters = test.at({0.37, 0.72});
  const auto stiff = response_target(test, parameters, {.task = Task::stress_strain, .factor = 3});
  EXPECT_FALSE(ways_out_of(test, held_problem(parameters, stiff)).way(Change::shorten));
}

TEST(WaysOut, NameAnotherFamilyThatMeetsTheTarget) {
  int missed = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const TestSpace test(2, seed);
    const TestSpace other(2, seed + 10);
    const TestSpace second(2, seed + 20);
    const DesignSpace others[] = {second.space(), other.space()};
    const auto target = response_target(other, other.at({0.3, 0.4}), {});
    const auto answer = ways_out_of(test, held_problem(test.at({0.37, 0.72}), target), others);
    if (!is_missed(answer)) continue;
    ++missed;
    const auto found = std::find_if(answer.ways.begin(), answer.ways.end(),
                                    [](const WayOut& way) { return way.other == std::optional<std::size_t>(1); });
    ASSERT_NE(found, answer.ways.end()) << seed;
    EXPECT_EQ(found->change, Change::family);
    EXPECT_LT(found->deviation, 0.05);
    EXPECT_TRUE(begins_with(*found, "Use the family " + other.model.family + ": ")) << found->sentence;
  }
  EXPECT_GT(missed, 0);
}

/// The target of a way out; a shortened one at the samples within its range.
Target target_after(const WayOut& way, Target target) {
  if (!way.range) return target;
  target.samples = 41;
  const auto whole = sample_target(target);
  target.control_points.clear();
  for (std::size_t i = 0; i < whole.samples.x.size(); ++i)
    if (whole.samples.x[i] >= way.range->least - 1e-9 && whole.samples.x[i] <= way.range->most + 1e-9)
      target.control_points.emplace_back(whole.samples.x[i], whole.y[static_cast<Eigen::Index>(i)]);
  target.samples = static_cast<int>(target.control_points.size());
  return target;
}

TEST(WaysOut, DeviateAsTheirParametersDoAndAreMuchBetterThanTheDesign) {
  int ways = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    for (const Task task : {Task::stress_strain, Task::stiffness, Task::poisson}) {
      const TestSpace test(2, seed);
      RandomStream random("targets with ways out", seed);
      auto target =
          response_target(test, test.at({random.uniform(), random.uniform()}),
                          {.task = task, .orientation = 3 * random.uniform(), .factor = 0.2 + 3 * random.uniform()});
      for (auto& point : target.control_points) point[1] *= 0.9 + 0.2 * random.uniform();
      const DesignProblem problem{{target}, {}, {}};
      const auto answer = ways_out_of(test, problem);
      double before = 0;
      for (const WayOut& way : answer.ways) {
        ++ways;
        EXPECT_GE(way.deviation, before) << "the best one comes first";
        before = way.deviation;
        EXPECT_LE(way.deviation, 0.7 * answer.design.error.relative_rms);
        EXPECT_LT(way.deviation, 0.15);
        auto sampled = sample_target(target_after(way, target));
        sampled.samples.orientation = way.orientation;
        const std::vector<double> parameters(way.parameters.begin(), way.parameters.end());
        auto profile = evaluate_profile(test.model, test.evaluator, parameters, sampled.samples);
        if (task != Task::poisson) profile.y *= way.youngs_modulus / test.model.provenance.youngs_modulus;
        EXPECT_NEAR(sampled.relative_rms(profile.y).value_or(1), way.deviation, 1e-6) << way.sentence;
      }
    }
  }
  EXPECT_GT(ways, 0);
}

TEST(WaysOut, AreNotSoughtWhereTheTargetIsReached) {
  const TestSpace test(2, 1);
  const auto parameters = test.at({0.37, 0.72});
  const auto answer = ways_out_of(test, held_problem(parameters, response_target(test, parameters, {.factor = 1.02})));
  EXPECT_TRUE(answer.ways.empty());
  EXPECT_FALSE(answer.effect().ran);
  EXPECT_EQ(answer.effect().why, "the target is reached");
}

TEST(WaysOut, FollowTheSimulationWhereThereIsOne) {
  const TestSpace test(2, 1);
  const auto parameters = test.at({0.37, 0.72});
  const DesignOptions options;
  const auto why = [&](double model_factor, double simulated_factor) {
    const auto problem = held_problem(parameters, response_target(test, parameters, {.factor = model_factor}));
    const Design design = find_design(test.space(), problem, options);
    Polished simulated;
    simulated.targets = {design.profiles[0].target};
    simulated.simulated = {simulated_factor * design.profiles[0].target.y};
    simulated.model = {design.profiles[0].achieved};
    simulated.youngs_modulus = design.youngs_modulus;
    simulated.target_error = std::abs(simulated_factor - 1);
    CostLedger bill;
    find_ways_out({test.space(), {}, problem, options, ample_seconds}, design, simulated, {.cost = &bill});
    return bill.effects().front().why;
  };
  EXPECT_EQ(why(3, 1), "the target is reached by the simulation");
  EXPECT_EQ(why(3, 2), "the target is missed");
  EXPECT_EQ(why(1, 2), "the target is missed by the simulation alone");
}

/// A design that meets its target by the model, and its simulation.
struct MissedBySimulation {
  MissedBySimulation(const TestSpace& its_test, const Response& response)
      : test(its_test),
        problem(held_problem(test.at({0.37, 0.72}), response_target(test, test.at({0.37, 0.72}), response))),
        design(find_design(test.space(), problem, options)) {
    simulated.targets = {design.profiles[0].target};
    simulated.model = simulated.simulated = {design.profiles[0].achieved};
    simulated.youngs_modulus = design.youngs_modulus;
  }
  std::vector<WayOut> ways() {
    simulated.target_error = simulated.targets[0].relative_rms(simulated.simulated[0]);
    return find_ways_out({test.space(), {}, problem, options, ample_seconds}, design, simulated);
  }

  const TestSpace& test;
  DesignOptions options;
  DesignProblem problem;
  Design design;
  Polished simulated;
};

const WayOut* way_among(const std::vector<WayOut>& ways, Change change) {
  const auto found = std::find_if(ways.begin(), ways.end(), [&](const WayOut& way) { return way.change == change; });
  return found == ways.end() ? nullptr : &*found;
}

TEST(WaysOut, TakeTheModulusOfTheSimulationWhereItAloneMisses) {
  const TestSpace test(2, 1);
  for (const Task task : {Task::stress_strain, Task::stiffness}) {
    MissedBySimulation missed(test, {.task = task});
    missed.simulated.simulated[0] *= 2;
    const auto ways = missed.ways();
    const WayOut* way = way_among(ways, Change::modulus);
    ASSERT_TRUE(way);
    EXPECT_NEAR(way->youngs_modulus, 0.5 * missed.design.youngs_modulus, 1e-6 * missed.design.youngs_modulus);
    EXPECT_LT(way->deviation, 1e-6);
    EXPECT_EQ(way->parameters, missed.design.parameters);
    EXPECT_NE(way->sentence.find(" instead of 100 % by the simulation."), std::string::npos) << way->sentence;
    EXPECT_EQ(way, &ways.front());
  }
}

TEST(WaysOut, ShortenTheRangeToWhatTheSimulationReaches) {
  const TestSpace test(2, 1);
  for (const double factor : {3.0, std::numeric_limits<double>::quiet_NaN()}) {
    MissedBySimulation missed(test, {.task = Task::stress_strain});
    missed.simulated.simulated[0].tail(8) *= factor;  // 13 of the 21 samples are met
    const auto ways = missed.ways();
    const WayOut* way = way_among(ways, Change::shorten);
    ASSERT_TRUE(way);
    EXPECT_EQ(way->range->least, 0);
    EXPECT_NEAR(way->range->most, 0.12, 1e-12);
    EXPECT_LT(way->deviation, 1e-6);
    EXPECT_TRUE(begins_with(*way, "Shorten the target to Green strains from 0 to 12 %: it is reached up to there, "))
        << way->sentence;
    EXPECT_NE(way->sentence.find(" % by the simulation."), std::string::npos) << way->sentence;
    EXPECT_EQ(way->sentence.find("instead of") == std::string::npos, std::isnan(factor)) << way->sentence;
  }
}

TEST(WaysOut, TurnByTheModelWithTheErrorThatTheSimulationHasFound) {
  int turned = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
    const TestSpace test(2, seed);
    for (const double angle : {-0.3, 0.2, 0.4}) {
      MissedBySimulation missed(test, {});
      // The real structure behaves as one that is turned.
      const auto of_turned = response_target(test, test.at({0.37, 0.72}), {.orientation = angle});
      for (int i = 0; i < 12; ++i)
        missed.simulated.simulated[0][i] = of_turned.control_points[static_cast<std::size_t>(i)][1];
      for (const WayOut& way : missed.ways()) {
        if (way.change != Change::turn) continue;
        ++turned;
        EXPECT_TRUE(begins_with(way, "Turn the tiling by ")) << way.sentence;
        EXPECT_NE(way.sentence.find(": about "), std::string::npos) << way.sentence;
        EXPECT_LE(way.deviation, 0.7 * *missed.simulated.target_error);
        EXPECT_EQ(way.youngs_modulus, missed.design.youngs_modulus);
      }
    }
  }
  EXPECT_GT(turned, 0);
}

TEST(WaysOut, AreThoseOfTheModelWhereNoSimulationHasEnded) {
  const TestSpace test(2, 1);
  MissedBySimulation missed(test, {});
  missed.simulated.simulated[0].setConstant(std::numeric_limits<double>::quiet_NaN());
  missed.simulated.stopped = PolishTermination::deadline;
  EXPECT_TRUE(missed.ways().empty()) << "the model reaches the target";
}

TEST(WaysOut, EndWithTheirTimeAndWithTheDeadline) {
  const TestSpace test(2, 1);
  const auto parameters = test.at({0.37, 0.72});
  const auto problem = held_problem(parameters, response_target(test, parameters, {.factor = 3}));
  const auto late = ways_out_of(test, problem, {}, 0);
  EXPECT_TRUE(late.ways.empty());
  EXPECT_EQ(late.effect().why, "the target is missed; the time for it passed before all was tried");

  const DesignOptions options;
  const Design design = find_design(test.space(), problem, options);
  const WaysOutSearch search{test.space(), {}, problem, options, ample_seconds};
  CostLedger bill;
  const CancellationToken deadline;
  deadline.request(StopReason::deadline);
  EXPECT_TRUE(find_ways_out(search, design, {}, {.cancellation = deadline, .cost = &bill}).empty());
  EXPECT_EQ(bill.effects().front().why, "the target is missed; the deadline passed before all was tried");

  const CancellationToken cancelled;
  cancelled.request(StopReason::cancelled);
  expect_cancelled(StopReason::cancelled, [&] { find_ways_out(search, design, {}, {.cancellation = cancelled}); });
}

TEST(WaysOut, EndAtALimitOfMemoryWithWhatTheyHave) {
  const TestSpace test(2, 1);
  const auto parameters = test.at({0.37, 0.72});
  const auto problem = held_problem(parameters, response_target(test, parameters, {.factor = 3}));
  const DesignOptions options;
  Design design = find_design(test.space(), problem, options);
  const WaysOutSearch search{test.space(), {}, problem, options, ample_seconds};
  const CancellationToken token;
  token.request(StopReason::memory);
  CostLedger bill;
  EXPECT_TRUE(find_ways_out(search, design, {}, {.cancellation = token, .cost = &bill}).empty());
  EXPECT_EQ(bill.effects().front().why, "the target is missed; a limit of memory was reached before all was tried");
  EXPECT_FALSE(token.requested()) << "the answer goes on";

  design.stopped = DesignTermination::deadline;
  CostLedger none;
  EXPECT_TRUE(find_ways_out(search, design, {}, {.cost = &none}).empty());
  EXPECT_FALSE(none.effects().front().ran);
}

TEST(WaysOut, StopSoonAfterTheyAreToldTo) {
  struct Canceller : ProgressSink {
    CancellationToken token;
    int reports = 0;
    void report(double fraction, std::string_view stage) override {
      EXPECT_EQ(stage, "ways_out");
      EXPECT_TRUE(fraction >= 0 && fraction < 1);
      if (++reports == 2) token.request(StopReason::superseded);
    }
  } sink;
  const TestSpace test(2, 1);
  const auto parameters = test.at({0.37, 0.72});
  const auto problem = held_problem(parameters, response_target(test, parameters, {.factor = 3}));
  const DesignOptions options;
  const Design design = find_design(test.space(), problem, options);
  expect_cancelled(StopReason::superseded, [&] {
    find_ways_out({test.space(), {}, problem, options, ample_seconds}, design, {},
                  {.cancellation = sink.token, .progress = &sink});
  });
}

TEST(WaysOut, MessagesSayThatACurveWithinTheEnvelopeNeedNotExist) {
  const TestSpace test(2, 1);
  DesignProblem problem{{response_target(test, test.at({0.5, 0.5}), {})}, {}, {}};
  const auto reached = find_design(test.space(), problem);
  EXPECT_EQ(reached.message.find("envelope"), std::string::npos) << reached.message;
  // The target jumps up and down within the envelope, at 0.3 and 0.7 of its width.
  const auto& envelope = reached.profiles[0];
  for (std::size_t i = 0; i < problem.targets[0].control_points.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const double fraction = i % 2 == 0 ? 0.3 : 0.7;
    problem.targets[0].control_points[i][1] =
        envelope.lowest[at] + fraction * (envelope.highest[at] - envelope.lowest[at]);
  }
  const auto missed = find_design(test.space(), problem);
  EXPECT_NE(missed.message.find("Each value of the target is within the envelope"), std::string::npos)
      << missed.message;
}

}  // namespace
}  // namespace supple::design
