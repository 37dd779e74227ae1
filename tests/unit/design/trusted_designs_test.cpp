#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "supple/base/cost_ledger.h"
#include "supple/design/inverse_design.h"
#include "support/test_calibration.h"
#include "test_space.h"

namespace supple::design {
namespace {

/// Error bars of the stress that are `middle` (relative) in the middle of the first parameter's bounds. They grow by
/// `factor` from there to one end of the bounds.
void add_growing_bars(neural::Model& model, double middle, double factor) {
  model.calibration = test::test_calibration(static_cast<int>(model.network.lower.size()));
  auto& scale = model.calibration->scales[static_cast<std::size_t>(neural::Quantity::stress)];
  scale.coefficients[1] = std::log(factor);
  scale.given.offsets = {std::log(middle + model.calibration->floor)};
}

/// Design::uncertainty of a design with one target, computed from the profile's error bars.
double expected_uncertainty(const DesignProfile& profile) {
  double sum = 0;
  for (std::size_t i = 0; i < profile.in_range.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    if (profile.in_range[i] == 0)
      sum += profile.target.weights[at] * std::pow(profile.error_bar[at] / 1.645 / profile.target.scale, 2);
  }
  return std::sqrt(sum);
}

TEST(InverseDesign, PrefersDesignsOfWhichTheModelCanBeTrusted) {
  int not_ends = 0;
  std::int64_t judged = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    TestSpace test(2, seed);
    const DesignProblem problem{{target_of(test, test.at({0.9, 0.4}), Task::stress_strain)}, {}, {}};
    add_growing_bars(test.model, 0.1, 20);
    const auto search = [&](Switch trust, CostLedger& bill) {
      DesignOptions options;
      options.trust = trust;
      return find_design(test.space(), problem, options, {.cost = &bill});
    };
    CostLedger nearest_bill;
    const auto nearest = search(Switch::off, nearest_bill);
    EXPECT_LT(nearest.error.relative_rms, 1e-3) << "the network knows a design that has the target";
    EXPECT_EQ(nearest.uncertainty, 0) << "nobody asked";
    EXPECT_GT(expected_uncertainty(nearest.profiles[0]), 0.2);
    CostLedger bill;
    const auto trusted = search(Switch::automatic, bill);
    EXPECT_NEAR(trusted.uncertainty, expected_uncertainty(trusted.profiles[0]), 1e-12);
    EXPECT_LT(std::hypot(trusted.error.relative_rms, trusted.uncertainty),
              0.9 * expected_uncertainty(nearest.profiles[0]))
        << seed;
    const auto told = [](const CostLedger& from) {
      const auto& effects = from.effects();
      return *std::find_if(effects.begin(), effects.end(), [](const auto& effect) { return effect.name == "trust"; });
    };
    EXPECT_FALSE(told(nearest_bill).ran);
    EXPECT_EQ(told(nearest_bill).count, 0);
    EXPECT_TRUE(told(bill).ran);
    EXPECT_EQ(told(bill).count > 0, told(bill).seconds > 0) << "others are looked for where the nearest is doubtful";
    judged += told(bill).count;
    EXPECT_NE(nearest.stopped, DesignTermination::trusted);
    not_ends += trusted.stopped == DesignTermination::trusted ? 1 : 0;
  }
  EXPECT_GT(not_ends, 0) << "the search ended elsewhere";
  EXPECT_GT(judged, 0);
}

TEST(InverseDesign, WeighsTrustWhereARequestSaysWhereToBeginOnlyIfItIsAsked) {
  TestSpace test(2, 1);
  const auto start = test.at({0.8, 0.5});
  const DesignProblem problem{{target_of(test, test.at({0.9, 0.4}), Task::stress_strain)}, vector_of(start), {}};
  add_growing_bars(test.model, 0.1, 20);
  const auto search = [&](Switch trust) {
    DesignOptions options;
    options.trust = trust;
    return find_design(test.space(), problem, options);
  };
  EXPECT_EQ(search(Switch::automatic).parameters, search(Switch::off).parameters);
  EXPECT_NE(search(Switch::on).parameters, search(Switch::off).parameters);
}

TEST(InverseDesign, DoesNotPreferAmongDesignsThatAreTrustedAlike) {
  TestSpace test(2, 2);
  const DesignProblem problem{{target_of(test, test.at({0.9, 0.4}), Task::stress_strain)}, {}, {}};
  const auto without = find_design(test.space(), problem);
  add_growing_bars(test.model, 0.02, 2);
  const auto with = find_design(test.space(), problem);
  EXPECT_EQ(with.parameters, without.parameters) << "bars of up to 4 % are short";
  EXPECT_EQ(with.uncertainty, 0);
}

TEST(InverseDesign, HasTheBarsOfSearchedDesignsWhereItSearched) {
  TestSpace test(2, 3);
  const auto parameters = test.at({0.4, 0.4});
  DesignProblem problem{{target_of(test, parameters, Task::stress_strain)}, {}, {}};
  test.model.calibration = test::test_calibration(2);
  auto& scale = test.model.calibration->scales[static_cast<std::size_t>(neural::Quantity::stress)];
  scale.searched.knots = {0};
  scale.searched.offsets = {std::log(0.04 + test.model.calibration->floor)};
  const auto share_of = [&] {
    const auto profile = find_design(test.space(), problem).profiles[0];
    return profile.error_bar.norm() / profile.achieved.norm();
  };
  EXPECT_NEAR(share_of(), 0.04, 1e-9);
  problem.fixed = {parameters[0], parameters[1]};
  EXPECT_NEAR(share_of(), 0.02, 1e-9) << "somebody else has chosen this design";
}

TEST(InverseDesign, ComparesWithTheModelsMeanErrorOnlyWhereItIsTrusted) {
  TestSpace test(2, 5);
  auto target = target_of(test, test.at({0.5, 0.5}), Task::stress_strain);
  for (auto& point : target.control_points) point[1] *= 100;
  test.model.design_split.emplace().gradient.mean = 10;
  const auto message = [&] { return find_design(test.space(), {{target}, {}, {}}).message; };
  add_growing_bars(test.model, 0.02, 1);
  EXPECT_NE(message().find("no more than the model errs in the mean"), std::string::npos) << message();
  add_growing_bars(test.model, 0.2, 1);
  EXPECT_EQ(message().find("no more than the model errs"), std::string::npos) << message();
  EXPECT_NE(message().find("verify"), std::string::npos) << message();
}

TEST(InverseDesign, RanksDoubtfulDesignsAsIfTheirModelErredByTheDoubt) {
  TestSpace doubtful(2, 11);
  TestSpace rough(2, 11);
  const DesignProblem problem{{target_of(rough, rough.at({0.3, 0.4}), Task::stress_strain)}, {}, {}};
  doubtful.model.design_split.emplace().gradient.mean = 0.01;
  rough.model.design_split.emplace().gradient.mean = 0.05;
  const std::vector<DesignSpace> spaces{doubtful.space(), rough.space()};
  EXPECT_EQ(find_designs(spaces, problem)[0].space, 0U);
  add_growing_bars(doubtful.model, 0.3, 1);
  EXPECT_EQ(find_designs(spaces, problem)[0].space, 1U);
}

}  // namespace
}  // namespace supple::design
