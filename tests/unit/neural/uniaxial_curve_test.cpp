#include "supple/neural/uniaxial_curve.h"

#include <gtest/gtest.h>

#include <vector>

#include "supple/base/cost_ledger.h"
#include "support/expect_error.h"
#include "support/test_calibration.h"
#include "support/test_model.h"

namespace supple::neural {
namespace {

TEST(UniaxialCurve, IsThePathWithItsTrust) {
  auto model = test::test_model("one", 1);
  model.calibration = test::test_calibration(2);
  const Evaluator evaluator(model.network);
  const std::vector<double> parameters{0.15, 0.65};
  const std::vector<double> strains{0, 0.02, 3};
  CostLedger bill;
  const auto curve = uniaxial_curve(model, evaluator, parameters, 0.3, strains, {}, {.cost = &bill});
  const auto path = uniaxial_path(evaluator, evaluator.design(parameters), 0.3, strains);
  ASSERT_EQ(curve.states.size(), 3U);
  ASSERT_EQ(curve.trust.size(), 3U);
  int iterations = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(curve.states[i].stress, path[i].stress);
    iterations += path[i].iterations;
  }
  ASSERT_EQ(bill.quantities().size(), 1U);
  EXPECT_EQ(bill.quantities()[0].value, iterations);
  EXPECT_TRUE(curve.trust[1].in_range);
  EXPECT_TRUE(curve.trust[1].error.has_value());
  EXPECT_FALSE(curve.trust[2].in_range);
}

TEST(UniaxialCurve, HasNoErrorBarWhereThereIsNoEquilibrium) {
  auto model = test::test_model("one", 1);
  model.calibration = test::test_calibration(2);
  const Evaluator evaluator(model.network);
  const std::vector<double> strains{0.02};
  const std::vector<double> parameters{0.15, 0.65};
  UniaxialOptions options;
  options.max_iterations = 1;
  options.tolerance = 1e-15;
  const auto curve = uniaxial_curve(model, evaluator, parameters, 0.3, strains, options);
  ASSERT_FALSE(curve.states[0].converged);
  EXPECT_FALSE(curve.trust[0].error.has_value());
}

TEST(UniaxialCurve, NamesTheStateWithoutAFiniteValue) {
  const auto huge = test::test_model("huge", 1, 1e160);
  const Evaluator evaluator(huge.network);
  const std::vector<double> strains{0, 0.02};
  const std::vector<double> parameters{0.15, 0.65};
  const auto call = [&] { uniaxial_curve(huge, evaluator, parameters, 0.3, strains); };
  testing::expect_error("model.not_finite", call);
}

}  // namespace
}  // namespace supple::neural
