#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "supple/base/random.h"
#include "supple/lab/family_learning.h"
#include "supple/tiling/family.h"
#include "support/expect_error.h"

namespace supple::lab {
namespace {

std::int64_t designs_of(const LearningPlan& plan) { return plan.even_designs + plan.rounds * plan.round_designs; }

TEST(LearningPlan, TakesTheTimeThatThereIs) {
  RandomStream random("learning_plan", 1);
  for (int k = 0; k < 300; ++k) {
    const int parameters = 1 + static_cast<int>(random.uniform(0, 4));
    const double design_seconds = std::exp(random.uniform(std::log(0.5), std::log(60)));
    const int states = 10 + static_cast<int>(random.uniform(0, 60));
    const double budget = std::exp(random.uniform(std::log(6e3), std::log(3e5)));
    const auto plan = plan_within(budget, design_seconds, states, parameters);
    const double total = cost_of(plan, design_seconds, states).total();
    EXPECT_LE(total, 1.001 * budget) << design_seconds << " s, " << states << " states";
    EXPECT_TRUE(total > 0.6 * budget || plan.epochs == 2000) << total << " of " << budget;
    EXPECT_GE(designs_of(plan), 15 * (parameters + 1));
    EXPECT_GE(plan.epochs, 150);
  }
}

TEST(LearningPlan, IsRefusedWithWhatItNeedsWhereThereIsTooLittleTime) {
  const auto error = testing::expect_error("training.small_budget", [] { (void)plan_within(600, 30, 39, 7); });
  EXPECT_EQ(testing::places(error), std::vector<std::string>{"budget/core_seconds"});
  const std::string text = error.what();
  EXPECT_NE(text.find("120 designs of 30 s"), std::string::npos) << text;
  // What it names suffices.
  const double needed = std::stod(text.substr(text.find("about ") + 6));
  EXPECT_GT(needed, 120 * 30);
  EXPECT_EQ(designs_of(plan_within(needed, 30, 39, 7)), 120);
}

TEST(LearningPlan, HasNoCommitteesWithFewDesigns) {
  EXPECT_EQ(plan_within(2500, 20, 39, 2).rounds, 0);
  const auto plan = plan_within(20'000, 20, 39, 2);
  EXPECT_GT(plan.rounds, 0);
  EXPECT_NEAR(static_cast<double>(plan.rounds * plan.round_designs), 0.5 * static_cast<double>(designs_of(plan)), 4);
}

TEST(LearningPlan, CostsMoreForMoreOfAnything) {
  const LearningPlan plan;
  const double before = cost_of(plan, 20, 39).total();
  for (const auto member : {&LearningPlan::rounds, &LearningPlan::members, &LearningPlan::member_width,
                            &LearningPlan::member_epochs, &LearningPlan::width, &LearningPlan::epochs}) {
    auto more = plan;
    more.*member *= 2;
    EXPECT_GT(cost_of(more, 20, 39).total(), before);
  }
  EXPECT_DOUBLE_EQ(cost_of(plan, 40, 39).simulation, 2 * cost_of(plan, 20, 39).simulation);
  EXPECT_DOUBLE_EQ(cost_of(plan, 20, 78).training, 2 * cost_of(plan, 20, 39).training);
}

TEST(LearningPlan, TimesDesignsOfTheFamily) {
  DatasetOptions options;
  options.family = "IH01";
  options.simulation.mesh.mesh_size = 1;
  options.loads = {.tension_paths = 1,
                   .compression_paths = 0,
                   .biaxial_paths = 2,
                   .tension_states = 2,
                   .biaxial_states = 3,
                   .max_stretch = 1.01};
  EXPECT_EQ(states_of(options), 2 + 2 * 3);
  const double seconds = design_seconds(options);
  EXPECT_GT(seconds, 0.01);
  EXPECT_LT(seconds, 60);
}

}  // namespace
}  // namespace supple::lab
