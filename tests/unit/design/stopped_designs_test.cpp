#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/design/inverse_design.h"
#include "support/expect_error.h"
#include "test_space.h"

namespace supple::design {
namespace {

using supple::testing::expect_cancelled;

TEST(InverseDesign, StopsWhenItIsTold) {
  const TestSpace test(3, 14);
  const DesignProblem problem{{target_of(test, test.at({0.1, 0.5, 0.6}), Task::poisson)}, {}, {}};
  const CancellationToken token;
  token.request(StopReason::cancelled);
  expect_cancelled(StopReason::cancelled, [&] { find_design(test.space(), problem, {}, {.cancellation = token}); });
}

TEST(InverseDesign, AnswersWithItsBestDesignIfTimeOrMemoryRunsOut) {
  const TestSpace test(2, 9);
  const DesignProblem problem{
      {target_of(test, test.at({0.2, 0.7}), Task::stress_strain)}, vector_of(test.at({0.9, 0.1})), {}};
  const double whole = find_design(test.space(), problem).error.relative_rms;
  for (const StopReason reason : {StopReason::deadline, StopReason::memory}) {
    const CancellationToken token;
    std::vector<double> errors;
    const auto design = find_design(test.space(), problem, {}, {.cancellation = token}, [&](const auto& news) {
      errors.push_back(news.error.relative_rms);
      if (errors.size() == 2) token.request(reason);
    });
    const bool is_late = reason == StopReason::deadline;
    EXPECT_EQ(design.stopped, is_late ? DesignTermination::deadline : DesignTermination::memory);
    ASSERT_EQ(errors.size(), 2U);
    EXPECT_NEAR(design.error.relative_rms, errors.back(), 1e-6);
    EXPECT_GT(design.error.relative_rms, whole);
    EXPECT_NE(design.message.find(is_late ? "The deadline passed before" : "A limit of memory was reached before"),
              std::string::npos)
        << design.message;
    EXPECT_FALSE(token.requested()) << "the report goes on";
  }
}

TEST(InverseDesign, HasNoAnswerIfTimeRunsOutBeforeItsFirstDesign) {
  const TestSpace test(3, 14);
  const DesignProblem problem{{target_of(test, test.at({0.1, 0.5, 0.6}), Task::poisson)}, {}, {}};
  const CancellationToken token;
  token.request(StopReason::deadline);
  expect_cancelled(StopReason::deadline, [&] { find_design(test.space(), problem, {}, {.cancellation = token}); });
  const std::vector<DesignSpace> spaces{test.space(), test.space()};
  expect_cancelled(StopReason::deadline, [&] { find_designs(spaces, problem, {}, {.cancellation = token}); });
}

TEST(InverseDesign, RanksTheBestDesignsOfFamiliesThatAreStopped) {
  const TestSpace first(2, 10);
  const TestSpace second(2, 11);
  const std::vector<DesignSpace> spaces{first.space(), second.space()};
  const DesignProblem problem{{target_of(second, second.at({0.3, 0.4}), Task::stiffness)}, {}, {}};
  const CancellationToken token;
  const auto ranking = find_designs(spaces, problem, {.multi_start = Switch::on}, {.cancellation = token},
                                    [&](const DesignProgress&) { token.request(StopReason::deadline); });
  ASSERT_FALSE(ranking.empty());
  EXPECT_EQ(ranking.front().stopped, DesignTermination::deadline);
  EXPECT_NE(ranking.front().message.find("The deadline passed before"), std::string::npos) << ranking.front().message;
  EXPECT_FALSE(token.requested());
}

TEST(InverseDesign, KeepsTheBestDesignOfTheMaterialsBeforeAStop) {
  const TestSpace test(2, 9);
  const double modulus = test.model.provenance.youngs_modulus;
  DesignProblem problem{
      {target_of(test, test.at({0.2, 0.7}), Task::stress_strain)}, vector_of(test.at({0.9, 0.1})), {}};
  problem.moduli = {{30 * modulus, 30 * modulus}, {modulus, modulus}};
  const CancellationToken token;
  int reports = 0;
  const auto design = find_design(test.space(), problem, {}, {.cancellation = token}, [&](const DesignProgress&) {
    if (++reports == 2) token.request(StopReason::deadline);
  });
  EXPECT_EQ(design.stopped, DesignTermination::deadline);
  EXPECT_EQ(design.material, 0U) << "the second one was not searched";
}

}  // namespace
}  // namespace supple::design
