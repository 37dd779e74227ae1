#include <gtest/gtest.h>

#include <vector>

#include "corrected_model.h"
#include "displaced_simulation.h"
#include "supple/design/verified_designs.h"
#include "support/test_calibration.h"

namespace supple::design {
namespace {

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

}  // namespace
}  // namespace supple::design
