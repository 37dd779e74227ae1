#include "supple/json/verdict_sentence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
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

}  // namespace
}  // namespace supple::json
