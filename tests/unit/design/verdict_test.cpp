#include "supple/design/verdict.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "supple/base/random.h"

namespace supple::design {
namespace {

using std::numbers::pi;

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// A random target with weights and bands.
SampledTarget random_target(RandomStream& random) {
  Target target;
  target.task = random.uniform() < 0.5 ? Task::stress_strain : random.uniform() < 0.5 ? Task::stiffness : Task::poisson;
  const bool over_strain = target.task == Task::stress_strain;
  const double low = over_strain ? random.uniform(-0.2, 0) : 0;
  const double high = over_strain ? low + random.uniform(0.05, 0.4) : 3;
  const int points = 2 + static_cast<int>(random.uniform(0, 5));
  for (int i = 0; i < points; ++i) {
    const double x = low + (high - low) * i / (points - 1);
    target.control_points.emplace_back(x, over_strain ? x + random.uniform(-0.05, 0.05) : random.uniform(-1, 2));
    target.weights.push_back(random.uniform(0, 2));
    target.bands.push_back(random.uniform() < 0.5 ? 0 : random.uniform(0, 0.01));
  }
  target.interpolation = numerics::Interpolation::linear;
  target.samples = 2 + static_cast<int>(random.uniform(0, 40));
  return sample_target(target);
}

/// A random curve near the target: it is up to `size` of its scale off, in stretches of several samples.
Eigen::VectorXd random_curve(const SampledTarget& target, double size, RandomStream& random) {
  Eigen::VectorXd values = target.y;
  double offset = 0;
  for (double& value : values) {
    if (random.uniform() < 0.3) offset = random.uniform() < 0.5 ? 0 : random.uniform(-size, size);
    value += offset * target.scale;
  }
  return values;
}

std::vector<std::uint8_t> flags(const SampledTarget& target, std::uint8_t flag) {
  return std::vector<std::uint8_t>(target.samples.x.size(), flag);
}

/// The curve that the target names, up to small numbers.
SampledTarget curve_through(const std::vector<double>& x, const std::vector<double>& y,
                            std::vector<double> weights = {}) {
  Target target;
  target.weights = std::move(weights);
  for (std::size_t i = 0; i < x.size(); ++i) target.control_points.emplace_back(x[i], y[i]);
  target.interpolation = numerics::Interpolation::linear;
  target.samples = static_cast<int>(x.size());
  return sample_target(target);
}

/// Rises to a plateau, from 0 to 20 %.
SampledTarget foam() { return curve_through({0, 0.04, 0.08, 0.12, 0.16, 0.2}, {0, 0.04, 0.08, 0.084, 0.088, 0.092}); }

void expect_ranges_of(const SampledTarget& target, const Eigen::VectorXd& values, const std::vector<FitRange>& ranges) {
  const auto& x = target.samples.x;
  ASSERT_FALSE(ranges.empty());
  EXPECT_EQ(ranges.front().from, x.front());
  EXPECT_DOUBLE_EQ(ranges.back().to, target.samples.task == Task::stress_strain ? x.back() : x.front() + pi);
  EXPECT_EQ(ranges.front().first, 0U);
  EXPECT_EQ(ranges.back().last + 1, x.size());
  const auto reached = target.reached(values);
  double sum = 0;
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    const FitRange& range = ranges[k];
    EXPECT_LE(range.from, range.to);
    if (k > 0) {
      EXPECT_EQ(range.from, ranges[k - 1].to);
      EXPECT_EQ(range.first, ranges[k - 1].last + 1);
      EXPECT_NE(range.fit, ranges[k - 1].fit);
    }
    bool all = true;
    for (std::size_t i = range.first; i <= range.last; ++i) {
      EXPECT_TRUE(x[i] >= range.from && x[i] <= range.to);
      all = all && (reached[i] != 0 || !target.has_weight(i));
    }
    EXPECT_EQ(range.is_reached(), all);
    ASSERT_TRUE(range.deviation);
    sum += range.weight * *range.deviation * *range.deviation;
  }
  EXPECT_NEAR(std::sqrt(sum), target.relative_rms(values).value(), 1e-12);
}

TEST(Verdict, IsReachedUpTo5PercentOrWhereEachSampleIsAndItsRangesAgreeWithTheSamples) {
  RandomStream random("verdicts", 1);
  int grades[4] = {0, 0, 0, 0};
  for (int i = 0; i < 2000; ++i) {
    const auto target = random_target(random);
    const auto values = random_curve(target, random.uniform(0, 1) < 0.5 ? 0.06 : 0.5, random);
    const auto verdict = judge({{{target, values}}, {flags(target, 1)}, {}});
    const double deviation = target.relative_rms(values).value();
    ++grades[static_cast<int>(verdict.grade)];
    EXPECT_EQ(verdict.deviation.value(), deviation);
    EXPECT_EQ(verdict.source, VerdictSource::model);
    const bool is_reached = deviation <= 0.05 || target.is_reached(values);
    EXPECT_EQ(verdict.grade == Grade::reached, is_reached);
    EXPECT_EQ(verdict.grade == Grade::missed, deviation > 0.15 && !is_reached);
    EXPECT_NE(verdict.grade, Grade::unknown);
    expect_ranges_of(target, values, verdict.targets[0].ranges);
  }
  for (const int grade : {0, 1, 2}) EXPECT_GT(grades[grade], 50) << "the generator finds each grade";
}

TEST(Verdict, IsThatOfTheSimulationWhereverThereIsOne) {
  RandomStream random("simulations", 2);
  for (int i = 0; i < 500; ++i) {
    const auto target = random_target(random);
    const auto simulated = random_curve(target, 1, random);
    const auto trusted = flags(target, random.uniform() < 0.5 ? 0 : 1);
    const auto verdict = judge({{{target, target.y}}, {trusted}, {{target, simulated}}});
    EXPECT_EQ(verdict.source, VerdictSource::simulation);
    const auto grade = target.is_reached(simulated) ? Grade::reached : grade_of(target.relative_rms(simulated).value());
    EXPECT_EQ(verdict.grade, grade) << "whether the model is trusted or not";
    EXPECT_EQ(verdict.model_deviation.value(), 0);
    expect_ranges_of(target, simulated, verdict.targets[0].ranges);
  }
}

TEST(Verdict, IsMissedWhereTheSimulationFinds45PercentAlthoughTheModelMeetsTheTarget) {
  const auto target = foam();
  const Eigen::VectorXd simulated = 1.45 * target.y;
  const auto verdict = judge({{{target, target.y}}, {flags(target, 1)}, {{target, simulated}}});
  EXPECT_EQ(verdict.grade, Grade::missed);
  EXPECT_NEAR(verdict.deviation.value(), 0.45, 1e-12);
  EXPECT_EQ(judge({{{target, target.y}}, {flags(target, 1)}, {}}).grade, Grade::reached);
}

TEST(Verdict, IsUnknownByAModelThatIsNotTrustedAtHalfOfTheSamples) {
  const auto target = foam();
  const auto with_untrusted = [&](std::size_t count) {
    auto trusted = flags(target, 1);
    std::fill_n(trusted.begin(), count, 0);
    return judge({{{target, target.y}}, {trusted}, {}});
  };
  EXPECT_EQ(with_untrusted(2).grade, Grade::reached);
  EXPECT_EQ(with_untrusted(3).grade, Grade::unknown);
  EXPECT_EQ(with_untrusted(3).doubt, Doubt::untrusted);
  EXPECT_EQ(with_untrusted(3).untrusted, 3U);
}

TEST(Verdict, IsUnknownWhereValuesOrTheStructureAreMissing) {
  const auto target = foam();
  Eigen::VectorXd simulated = target.y;
  simulated[5] = no_value;
  const auto incomplete = judge({{{target, target.y}}, {flags(target, 1)}, {{target, simulated}}});
  EXPECT_EQ(incomplete.grade, Grade::unknown);
  EXPECT_EQ(incomplete.doubt, Doubt::incomplete);
  EXPECT_FALSE(incomplete.deviation);
  ASSERT_EQ(incomplete.targets[0].ranges.size(), 2U);
  EXPECT_TRUE(incomplete.targets[0].ranges[0].is_reached());
  EXPECT_EQ(incomplete.targets[0].ranges[1].fit, Fit::missing);
  EXPECT_FALSE(incomplete.targets[0].ranges[1].deviation);
  EXPECT_EQ(judge({{{target, target.y}}, {flags(target, 1)}, {}, false}).doubt, Doubt::no_structure);
}

TEST(Verdict, IsThatOfTheWorstTarget) {
  const auto target = foam();
  const Eigen::VectorXd off = 1.1 * target.y;
  const auto verdict = judge({{{target, target.y}, {target, off}}, {flags(target, 1), flags(target, 1)}, {}});
  EXPECT_EQ(verdict.worst, 1U);
  EXPECT_EQ(verdict.grade, Grade::close);
  EXPECT_NEAR(verdict.deviation.value(), 0.1, 1e-12);
}

/// A target of Poisson's ratio that is the same in all directions.
SampledTarget isotropic_poisson(double ratio) {
  Target target;
  target.task = Task::poisson;
  target.control_points = {{0, ratio}, {1, ratio}};
  target.interpolation = numerics::Interpolation::linear;
  target.samples = 6;
  return sample_target(target);
}

TEST(Verdict, IsReachedWherePoissonsRatiosNear0AreWithin2Hundredths) {
  const auto target = isotropic_poisson(0.01);
  const auto verdict_at = [&](double ratio) {
    const Eigen::VectorXd values = Eigen::VectorXd::Constant(6, ratio);
    return judge({{{target, values}}, {flags(target, 1)}, {}});
  };
  const auto near = verdict_at(0.0299);
  EXPECT_EQ(near.grade, Grade::reached);
  EXPECT_NEAR(near.deviation.value(), 0.199, 1e-12) << "the deviation that is said remains relative";
  ASSERT_EQ(near.targets[0].ranges.size(), 1U);
  EXPECT_TRUE(near.targets[0].ranges[0].is_reached());
  EXPECT_EQ(verdict_at(0.0301).grade, Grade::missed);
  const auto large = isotropic_poisson(3);
  const Eigen::VectorXd values = Eigen::VectorXd::Constant(6, 3.029);
  EXPECT_TRUE(large.is_reached(values)) << "1 % of large ones is more";
}

TEST(Verdict, IsThatOfATargetThatIsMissedAndNotOfPoissonsRatiosNear0ThatAreReached) {
  const auto poisson = isotropic_poisson(0);
  const Eigen::VectorXd near = Eigen::VectorXd::Constant(6, 0.019);
  const auto stress = foam();
  const Eigen::VectorXd off = 1.08 * stress.y;
  const auto verdict = judge({{{poisson, near}, {stress, off}}, {flags(poisson, 1), flags(stress, 1)}, {}});
  EXPECT_EQ(verdict.worst, 1U);
  EXPECT_EQ(verdict.grade, Grade::close);
  EXPECT_NEAR(verdict.deviation.value(), 0.08, 1e-12);
}

std::vector<std::string> parts_of(const SampledTarget& target, const Eigen::VectorXd& values) {
  std::vector<std::string> parts;
  for (const FitRange& range : fit_ranges(target, values))
    parts.push_back(std::string(to_string(range.part)) + (range.is_reached() ? "" : " not"));
  return parts;
}

using Parts = std::vector<std::string>;

TEST(FitRanges, AreCalledByTheShapeOfTheTarget) {
  const auto rise_and_plateau = foam();
  Eigen::VectorXd values = rise_and_plateau.y;
  values.head(2) *= 2;
  EXPECT_EQ(parts_of(rise_and_plateau, values), (Parts{"rise not", "plateau"}));
  const auto densifies = curve_through({0, 0.04, 0.08, 0.12, 0.16, 0.2}, {0, 0.04, 0.042, 0.044, 0.1, 0.2});
  values = densifies.y;
  values.tail(2) *= 0.5;
  EXPECT_EQ(parts_of(densifies, values), (Parts{"beginning", "stiffening not"}));
  const auto drops = curve_through({0, 0.04, 0.08, 0.12, 0.16, 0.2}, {0, 0.04, 0.08, 0.12, 0.08, 0.06});
  values = drops.y;
  values.tail(2) *= 1.5;
  EXPECT_EQ(parts_of(drops, values), (Parts{"rise", "drop not"}));
}

TEST(FitRanges, AreSeenFromRestInCompressionToo) {
  const auto compression =
      curve_through({-0.2, -0.16, -0.12, -0.08, -0.04, 0}, {-0.092, -0.088, -0.084, -0.08, -0.04, 0});
  Eigen::VectorXd values = compression.y;
  values.tail(2) *= 2;
  EXPECT_EQ(parts_of(compression, values), (Parts{"plateau", "rise not"}));
  const auto both = curve_through({-0.1, -0.05, 0, 0.05, 0.1}, {-1, -0.5, 0, 0.5, 1});
  values = both.y;
  values.tail(2) *= 2;
  EXPECT_EQ(parts_of(both, values), (Parts{"compression", "tension not"}));
  EXPECT_EQ(fit_ranges(both, values)[0].to, 0) << "the ranges meet at rest";
}

TEST(FitRanges, DoNotCountRestWhichEachDesignReaches) {
  const auto target = foam();
  const Eigen::VectorXd values = 3 * target.y;
  const auto ranges = fit_ranges(target, values);
  ASSERT_EQ(ranges.size(), 1U);
  EXPECT_EQ(ranges[0].from, 0);
  EXPECT_FALSE(ranges[0].is_reached());
}

TEST(FitRanges, CountZerosOfTheTargetAwayFromRest) {
  const auto target = curve_through({0, 0.04, 0.08, 0.12, 0.16, 0.2}, {0, 0.1, 0, 0, 0, 0.1});
  Eigen::VectorXd values = target.y;
  values[1] = values[5] = 0.2;
  const auto ranges = fit_ranges(target, values);
  ASSERT_EQ(ranges.size(), 3U);
  EXPECT_FALSE(ranges[0].is_reached() || ranges[2].is_reached());
  EXPECT_TRUE(ranges[1].is_reached());
  EXPECT_NEAR(ranges[1].from, 0.06, 1e-12);
  EXPECT_NEAR(ranges[1].to, 0.18, 1e-12);
}

TEST(FitRanges, SpeakOfRestAndNotOfTensionWhereAPreloadIsMissed) {
  const auto missed_at = [](const SampledTarget& target, Eigen::Index sample) {
    Eigen::VectorXd values = target.y;
    values[sample] = 0;
    return parts_of(target, values);
  };
  const std::vector<double> strains{0, 0.04, 0.08, 0.12, 0.16, 0.2};
  const std::vector<double> negative{-0.2, -0.16, -0.12, -0.08, -0.04, 0};
  const auto compression = curve_through(negative, {-0.7, -0.6, -0.5, -0.4, -0.3, -0.2});
  EXPECT_EQ(missed_at(compression, 5), (Parts{"whole", "around_rest not"}));
  const auto tension = curve_through(strains, {0.2, 0.3, 0.4, 0.5, 0.6, 0.7});
  EXPECT_EQ(missed_at(tension, 0), (Parts{"around_rest not", "whole"}));
  const auto both = curve_through({-0.1, -0.05, 0, 0.05, 0.1}, {-0.5, 0.1, 0.5, 1, 1.5});
  EXPECT_EQ(missed_at(both, 2), (Parts{"compression", "around_rest not", "tension"}));
}

TEST(Verdict, DoesNotCountSamplesWithoutWeight) {
  const auto target =
      curve_through({0, 0.04, 0.08, 0.12, 0.16, 0.2}, {0, 0.04, 0.08, 0.084, 0.088, 0.092}, {1, 1, 1, 0, 0, 1});
  Eigen::VectorXd values = target.y;
  auto trusted = flags(target, 1);
  trusted[2] = trusted[3] = trusted[4] = 0;
  for (const double value : {0.3, no_value}) {
    values[3] = values[4] = value;
    const auto verdict = judge({{{target, values}}, {trusted}, {}});
    EXPECT_EQ(verdict.grade, Grade::reached);
    EXPECT_EQ(verdict.deviation, 0);
    EXPECT_EQ(verdict.samples, 4U);
    EXPECT_EQ(verdict.untrusted, 1U);
    const TargetVerdict& judged = verdict.targets[0];
    EXPECT_EQ(judged.samples, 4U);
    EXPECT_EQ(judged.reached, 4U);
    ASSERT_EQ(judged.ranges.size(), 1U);
    EXPECT_TRUE(judged.ranges[0].is_reached());
    EXPECT_EQ(judged.ranges[0].deviation, 0);
  }
  values[5] = 0.3;
  const auto ranges = fit_ranges(target, values);
  ASSERT_EQ(ranges.size(), 2U);
  EXPECT_NEAR(ranges[0].to, 0.14, 1e-12) << "the ranges meet amid the samples without weight";
}

TEST(FitRanges, OverDirectionsGoOnAfterHalfATurn) {
  Target target;
  target.task = Task::stiffness;
  target.control_points = {{0, 1}, {1.5, 1}};
  target.samples = 12;
  const auto sampled = sample_target(target);
  Eigen::VectorXd values = sampled.y;
  values[0] = values[11] = 2;
  const auto ranges = fit_ranges(sampled, values);
  ASSERT_EQ(ranges.size(), 3U);
  const auto joined = joined_across_period(ranges, Task::stiffness);
  ASSERT_EQ(joined.size(), 2U);
  EXPECT_NEAR(joined[0].from, -1.5 * pi / 12, 1e-12);
  EXPECT_NEAR(joined[0].to, 0.5 * pi / 12, 1e-12);
  EXPECT_NEAR(joined[0].deviation.value(), 1, 1e-12);
  EXPECT_TRUE(joined[1].is_reached());
}

}  // namespace
}  // namespace supple::design
