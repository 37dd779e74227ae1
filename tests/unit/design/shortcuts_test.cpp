#include "supple/design/shortcuts.h"

#include <gtest/gtest.h>

#include "support/test_model.h"

namespace supple::design {
namespace {

DesignProblem small_problem() {
  DesignProblem problem;
  problem.targets.resize(1);
  problem.targets[0].control_points = {{0, 0}, {0.02, 0.1}};
  problem.targets[0].samples = 2;
  return problem;
}

TEST(FindDesign, OfAModelSearchesItsDesignSpace) {
  const neural::Model model = test::test_model("ih21", 1);
  const neural::Evaluator evaluator(model.network);
  const Candidates candidates(model.network);
  const Design expected = find_design(design_space(model, evaluator, candidates), small_problem());
  const Design found = find_design(model, small_problem());
  EXPECT_EQ(found.parameters, expected.parameters);
  EXPECT_EQ(found.error.relative_rms, expected.error.relative_rms);
}

TEST(FindVerifiedDesign, SimulatesTheDesign) {
  VerificationPlan plan;
  plan.polish = Switch::off;
  const VerifiedDesigns found = find_verified_design(test::test_model("ih21", 1), small_problem(), plan);
  ASSERT_EQ(found.ranking.size(), 1u);
  EXPECT_TRUE(found.polished.has_value());
  EXPECT_TRUE(found.ranking.front().target_error.has_value());
}

}  // namespace
}  // namespace supple::design
