#include "supple/json/verdict_sentence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "supple/json/design_requests.h"

namespace supple::json {
namespace {

using nlohmann::json;

/// The table that the server compiles in and that the web editor reads.
json table() { return json::parse(std::ifstream(SUPPLE_SOURCE_DIR "/api/verdicts.json")); }

Eigen::VectorXd values_of(const json& list) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(list.size()));
  for (std::size_t i = 0; i < list.size(); ++i)
    values[static_cast<Eigen::Index>(i)] =
        list[i].is_null() ? std::numeric_limits<double>::quiet_NaN() : list[i].get<double>();
  return values;
}

design::SampledTarget target_of(const json& sample) {
  design::SampledTarget target;
  target.samples.task = task_names.find(sample["task"].get<std::string>()).value();
  target.samples.x = sample["x"].get<std::vector<double>>();
  target.y = values_of(sample["target"]);
  const auto n = target.y.size();
  target.weights.setConstant(n, 1 / static_cast<double>(n));
  target.bands.setZero(n);
  target.scale =
      std::max(design::min_scale(target.samples.task), std::sqrt(target.y.squaredNorm() / static_cast<double>(n)));
  return target;
}

design::Evidence evidence_of(const json& sample) {
  design::Evidence evidence;
  evidence.has_structure = sample["has_structure"];
  for (const auto& one : sample["targets"]) {
    const auto target = target_of(one);
    evidence.model.push_back({target, values_of(one["model"])});
    auto& trusted = evidence.trusted.emplace_back();
    for (const bool flag : one["in_range"]) trusted.push_back(flag ? 1 : 0);
    if (!one["simulated"].is_null()) evidence.simulated.push_back({target, values_of(one["simulated"])});
  }
  return evidence;
}

TEST(VerdictSentence, IsThatOfEachWorkedSample) {
  const auto samples = table()["samples"];
  ASSERT_GT(samples.size(), 10U);
  for (const auto& sample : samples) {
    const auto verdict = design::judge(evidence_of(sample));
    const auto name = sample["name"].get<std::string>();
    EXPECT_EQ(verdict_sentence(verdict), sample["sentence"].get<std::string>()) << name;
    EXPECT_EQ(design::to_string(verdict.grade), sample["grade"].get<std::string>()) << name;
    EXPECT_EQ(design::to_string(verdict.source), sample["source"].get<std::string>()) << name;
  }
}

TEST(VerdictSentence, HasTheLimitsOfTheTable) {
  const auto limits = table()["limits"];
  EXPECT_EQ(limits["reached"], design::max_reached_deviation);
  EXPECT_EQ(limits["close"], design::max_close_deviation);
  EXPECT_EQ(limits["sample"], design::reached_fraction);
  EXPECT_EQ(limits["poisson_sample"], design::reached_poisson_deviation);
  EXPECT_EQ(limits["untrusted"], design::untrusted_fraction);
  EXPECT_EQ(limits["ranges"], max_ranges_in_words);
  EXPECT_EQ(limits["around"], max_degrees_around);
}

TEST(VerdictSentence, LeavesNoSlotEmpty) {
  const auto samples = table()["samples"];
  for (const auto& sample : samples) {
    const auto sentence = verdict_sentence(design::judge(evidence_of(sample)));
    EXPECT_EQ(sentence.find_first_of("{}"), std::string::npos) << sentence;
    EXPECT_EQ(sentence.find("  "), std::string::npos) << sentence;
    EXPECT_EQ(sentence.back(), '.') << sentence;
  }
}

design::SampledTarget target_over_directions(design::Task task, double value) {
  design::SampledTarget target;
  target.samples.task = task;
  target.samples.x = {0, 1, 2};
  target.y.setConstant(3, value);
  target.weights.setConstant(3, 1 / 3.0);
  target.bands.setZero(3);
  target.scale = value;
  return target;
}

/// A target of the value 1 and its bound: materials come as near as `alone` and, with others, as near as `together`.
void add_target(BoundedTargets& bounded, design::Task task, double alone, std::optional<double> together = {}) {
  const auto target = target_over_directions(task, 1);
  bounded.targets.push_back(target);
  bounded.weights.push_back(1);
  design::MaterialBound bound{{alone, (1 + alone) * target.y}, {}};
  if (together) bound.together = design::RestProfile{*together, (1 + *together) * target.y};
  bounded.bounds.targets.emplace_back(bound);
  if (together) bounded.bounds.together = together;
}

/// The verdict on a design that deviates so far from each target.
design::Verdict verdict_on(const BoundedTargets& bounded, double deviation) {
  design::Evidence evidence;
  for (const auto& target : bounded.targets) {
    evidence.model.push_back({target, (1 + deviation) * target.y});
    evidence.trusted.emplace_back(3, std::uint8_t{1});
  }
  return design::judge(evidence);
}

TEST(BoundSentence, SaysHowNearAnyMaterialComesToATargetThatIsBeyondReach) {
  BoundedTargets bounded;
  add_target(bounded, design::Task::stiffness, 0.07);
  EXPECT_EQ(bound_sentence(verdict_on(bounded, 0.2), bounded), "No material at rest comes nearer than 7 % to it.");
  EXPECT_EQ(bound_sentence(verdict_on(bounded, 0.06), bounded), "") << "strain brought the design nearer";
  EXPECT_EQ(bound_sentence(verdict_on(bounded, 0.01), bounded), "") << "the design reaches it";
  BoundedTargets within_reach;
  add_target(within_reach, design::Task::stiffness, 0.04);
  EXPECT_EQ(bound_sentence(verdict_on(within_reach, 0.2), within_reach), "");
  BoundedTargets without_bound;
  without_bound.targets = bounded.targets;
  without_bound.weights = bounded.weights;
  without_bound.bounds.targets.emplace_back();
  EXPECT_EQ(bound_sentence(verdict_on(without_bound, 0.2), without_bound), "");
}

TEST(BoundSentence, NamesTheTargetOfSeveralOrTheirNumber) {
  BoundedTargets bounded;
  add_target(bounded, design::Task::stiffness, 0.01, 0.2);
  add_target(bounded, design::Task::poisson, 0.125, 0.2);
  EXPECT_EQ(bound_sentence(verdict_on(bounded, 0.5), bounded),
            "No material at rest comes nearer than 13 % to target 2.");
  BoundedTargets conflict;
  add_target(conflict, design::Task::stiffness, 0.01, 0.25);
  add_target(conflict, design::Task::poisson, 0.01, 0.25);
  EXPECT_EQ(bound_sentence(verdict_on(conflict, 0.5), conflict),
            "No material at rest comes nearer than 25 % to the 2 targets of stiffness and Poisson's ratio together.");
  EXPECT_EQ(bound_sentence(verdict_on(conflict, 0.2), conflict), "") << "the design comes nearer";
}

}  // namespace
}  // namespace supple::json
