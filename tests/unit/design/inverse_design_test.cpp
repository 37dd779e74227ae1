#include "supple/design/inverse_design.h"

#include <gtest/gtest.h>

#include <cmath>
#include <mutex>
#include <numbers>

#include "support/expect_error.h"
#include "test_space.h"

namespace supple::design {
namespace {

using supple::testing::expect_error;
using supple::testing::places;

using std::numbers::pi;

/// A target that the given parameters have exactly at its control points, which are its samples.
Target target_of(const TestSpace& test, const std::vector<double>& parameters, Task task, int points = 12) {
  Target target;
  target.task = task;
  target.direction = 0.3;
  target.strain = 0.1;
  target.samples = points;
  ProfileSamples samples{task, target.direction, target.strain, StrainMeasure::green, {}};
  for (int i = 0; i < points; ++i)
    samples.x.push_back(task == Task::stress_strain ? -0.1 + 0.3 * i / (points - 1) : pi * i / points);
  const auto profile = evaluate_profile(test.model, test.evaluator, parameters, samples);
  for (int i = 0; i < points; ++i)
    target.control_points.emplace_back(samples.x[static_cast<std::size_t>(i)], profile.y[i]);
  return target;
}

Eigen::VectorXd vector_of(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

class EveryTask : public ::testing::TestWithParam<Task> {};
INSTANTIATE_TEST_SUITE_P(InverseDesign, EveryTask,
                         ::testing::Values(Task::stress_strain, Task::stiffness, Task::poisson),
                         [](const auto& task) { return std::string(to_string(task.param)); });

TEST_P(EveryTask, FindsTheDesignThatTheTargetWasMadeFrom) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const TestSpace test(2, seed);
    const auto parameters = test.at({0.37, 0.72});
    const DesignProblem problem{{target_of(test, parameters, GetParam())}, {}, {}};
    CostLedger bill;
    const auto design = find_design(test.space(), problem, {}, {.cost = &bill});
    EXPECT_LT(design.error.relative_rms, 1e-3) << seed;
    EXPECT_TRUE(design.reached);
    EXPECT_EQ(design.message, "");
    EXPECT_LE(design.residual, 1e-10);
    EXPECT_GE(design.profiles[0].lowest.size(), 1);
    EXPECT_TRUE((design.profiles[0].lowest.array() <= design.profiles[0].achieved.array()).all());
    EXPECT_TRUE(bill.effects().front().ran) << "candidates, without initial parameters";
  }
}

TEST_P(EveryTask, StartsWhereItIsTold) {
  const TestSpace test(2, 4);
  const auto parameters = test.at({0.5, 0.5});
  const auto start = test.at({0.45, 0.55});
  const DesignProblem problem{{target_of(test, parameters, GetParam())}, vector_of(start), {}};
  CostLedger bill;
  const auto design = find_design(test.space(), problem, {}, {.cost = &bill});
  EXPECT_EQ(design.starts, 1);
  EXPECT_FALSE(bill.effects().front().ran);
  EXPECT_LT((design.parameters - vector_of(parameters)).norm(), 1e-3);
  const auto& profile = design.profiles[0];
  const auto initial = evaluate_profile(test.model, test.evaluator, start, profile.target.samples);
  EXPECT_LT((profile.initial - initial.y).norm(), 1e-8 * initial.y.norm());
  const std::vector<double> found(design.parameters.begin(), design.parameters.end());
  const auto achieved = evaluate_profile(test.model, test.evaluator, found, profile.target.samples);
  EXPECT_LT((profile.achieved - achieved.y).norm(), 1e-8 * achieved.y.norm());
}

TEST(InverseDesign, SaysThatATargetIsOutOfReachAndGivesTheClosest) {
  const TestSpace test(2, 5);
  auto target = target_of(test, test.at({0.5, 0.5}), Task::stress_strain);
  for (auto& point : target.control_points) point[1] *= 100;
  const auto design = find_design(test.space(), {{target}, {}, {}});
  EXPECT_FALSE(design.reached);
  EXPECT_GT(design.error.relative_rms, 0.1);
  EXPECT_NE(design.message.find("closest"), std::string::npos) << design.message;
  // No design nearby or among many others is closer.
  const auto sampled = sample_target(target);
  const auto error = [&](const std::vector<double>& parameters) {
    const auto profile = evaluate_profile(test.model, test.evaluator, parameters, sampled.samples);
    return std::sqrt(sampled.weights.dot(sampled.deviations(profile.y).cwiseAbs2())) / sampled.scale;
  };
  RandomStream random("out of reach", 1);
  for (int i = 0; i < 100; ++i)
    EXPECT_GE(error(test.at({random.uniform(), random.uniform()})), design.error.relative_rms - 1e-6);
}

TEST(InverseDesign, SaysInDegreesWhereATargetIsMissedAndWhetherTheModelErrsByMore) {
  TestSpace test(2, 5);
  auto target = target_of(test, test.at({0.5, 0.5}), Task::stiffness);
  for (auto& point : target.control_points) point[1] *= 100;
  const auto missed = find_design(test.space(), {{target}, {}, {}});
  EXPECT_EQ(missed.message.rfind("No design of IH5 that was found reaches the target", 0), 0U) << missed.message;
  EXPECT_NE(missed.message.find(" degrees."), std::string::npos) << missed.message;
  test.model.design_split.emplace().gradient.mean = 10;
  const auto trusted = find_design(test.space(), {{target}, {}, {}});
  EXPECT_EQ(trusted.message.find("No design"), std::string::npos) << trusted.message;
  EXPECT_NE(trusted.message.find("no more than the model errs in the mean (1e+03 %)"), std::string::npos)
      << trusted.message;
}

TEST(InverseDesign, KeepsFixedParametersAndTheBounds) {
  const TestSpace test(3, 6);
  const auto parameters = test.at({0.5, 0.9, 0.2});
  DesignProblem problem{{target_of(test, parameters, Task::stiffness)}, {}, {}};
  problem.fixed = {std::nullopt, parameters[1], std::nullopt};
  const auto design = find_design(test.space(), problem);
  EXPECT_EQ(design.parameters[1], parameters[1]);
  EXPECT_LT(design.error.relative_rms, 1e-4);
  problem.fixed = {parameters[0], test.at({0, 0.1, 0})[1], parameters[2]};
  const auto held = find_design(test.space(), problem);
  EXPECT_EQ(held.stopped, DesignStop::no_free_parameters);
  EXPECT_EQ(held.starts, 1);
  EXPECT_EQ(held.parameters[1], *problem.fixed[1]);
}

TEST(InverseDesign, KeepsToParametersThatCanBeBuilt) {
  const TestSpace test(2, 4);
  const double limit = test.at({0.6, 0})[0];
  auto space = test.space();
  space.buildable = [limit](const Eigen::VectorXd& parameters) { return parameters[0] <= limit; };
  const DesignProblem problem{{target_of(test, test.at({0.8, 0.5}), Task::stress_strain)}, {}, {}};
  const auto design = find_design(space, problem);
  EXPECT_LE(design.parameters[0], limit);
  const TestSpace other(2, 4);
  EXPECT_GT(find_design(other.space(), problem).parameters[0], limit) << "it would go beyond";
  const TestSpace none(2, 4);
  auto nowhere = none.space();
  nowhere.buildable = [](const Eigen::VectorXd&) { return false; };
  expect_error("design.no_equilibrium", [&] { find_design(nowhere, problem, {.candidates = 3}); });
}

TEST(InverseDesign, WeighsSeveralTargetsAgainstEachOther) {
  const TestSpace test(2, 7);
  auto stress = target_of(test, test.at({0.2, 0.3}), Task::stress_strain);
  auto poisson = target_of(test, test.at({0.8, 0.6}), Task::poisson);
  const auto errors = [&](double weight) {
    poisson.weight = weight;
    const auto design = find_design(test.space(), {{stress, poisson}, {}, {}});
    std::vector<double> result;
    for (const auto& profile : design.profiles)
      result.push_back(std::sqrt(profile.target.weights.dot(profile.target.deviations(profile.achieved).cwiseAbs2())) /
                       profile.target.scale);
    EXPECT_NEAR(design.error.relative_rms,
                std::sqrt((result[0] * result[0] + weight * result[1] * result[1]) / (1 + weight)), 1e-9);
    return result;
  };
  const auto light = errors(1e-3);
  const auto heavy = errors(1e3);
  EXPECT_LT(light[0], heavy[0]);
  EXPECT_GT(light[1], heavy[1]);
}

TEST(InverseDesign, IsContentWithinTheBands) {
  const TestSpace test(2, 8);
  auto target = target_of(test, test.at({0.5, 0.5}), Task::stress_strain);
  target.bands.assign(target.control_points.size(), 1e6);
  const auto design = find_design(test.space(), {{target}, vector_of(test.at({0.1, 0.9})), {}});
  EXPECT_EQ(design.stopped, DesignStop::reached);
  EXPECT_EQ(design.iterations, 0);
  EXPECT_EQ(design.error.relative_rms, 0);
}

TEST(InverseDesign, ReportsEachBetterDesign) {
  const TestSpace test(2, 9);
  const DesignProblem problem{
      {target_of(test, test.at({0.2, 0.7}), Task::stress_strain)}, vector_of(test.at({0.9, 0.1})), {}};
  std::vector<double> errors;
  const auto design = find_design(test.space(), problem, {}, {}, [&](const DesignProgress& news) {
    errors.push_back(news.error.relative_rms);
    EXPECT_EQ(news.achieved.size(), 12);
    EXPECT_EQ(news.parameters.size(), 2);
  });
  EXPECT_GE(errors.size(), 3U);
  EXPECT_TRUE(std::is_sorted(errors.rbegin(), errors.rend()));
  EXPECT_NEAR(errors.back(), design.error.relative_rms, 1e-6);
}

TEST(InverseDesign, RanksFamilies) {
  const TestSpace first(1, 10);
  const TestSpace second(2, 11);
  const TestSpace third(3, 12);
  const std::vector<DesignSpace> spaces{first.space(), second.space(), third.space()};
  const DesignProblem problem{{target_of(second, second.at({0.3, 0.4}), Task::stiffness)}, {}, {}};
  CostLedger bill;
  const auto ranking = find_designs(spaces, problem, {}, {.cost = &bill});
  ASSERT_EQ(ranking.size(), 3U);
  EXPECT_EQ(ranking[0].space, 1U);
  EXPECT_LE(ranking[0].error.relative_rms, ranking[1].error.relative_rms);
  EXPECT_LE(ranking[1].error.relative_rms, ranking[2].error.relative_rms);
}

TEST(InverseDesign, RanksFamiliesByWhatTheirModelsKnowToo) {
  TestSpace exact(2, 11);
  TestSpace rough(2, 11);
  TestSpace unknown(2, 11);
  const DesignProblem problem{{target_of(exact, exact.at({0.3, 0.4}), Task::stiffness)}, {}, {}};
  exact.model.design_split.emplace().gradient.mean = 0.01;
  rough.model.design_split.emplace().gradient.mean = 0.08;
  const std::vector<DesignSpace> spaces{unknown.space(), rough.space(), exact.space()};
  const auto ranking = find_designs(spaces, problem);
  ASSERT_EQ(ranking.size(), 3U);
  EXPECT_EQ(ranking[0].space, 2U);
  EXPECT_EQ(ranking[1].space, 1U);
  EXPECT_EQ(ranking[2].space, 0U);
  EXPECT_EQ(ranking[0].model_error, 0.01);
  EXPECT_FALSE(ranking[2].model_error);
  EXPECT_EQ(ranking[0].error.relative_rms, ranking[1].error.relative_rms) << "the networks are the same";
}

TEST(InverseDesign, GivesTheSameAnswerAgain) {
  const TestSpace test(3, 13);
  const DesignProblem problem{{target_of(test, test.at({0.1, 0.5, 0.6}), Task::poisson)}, {}, {}};
  const auto first = find_design(test.space(), problem);
  const auto again = find_design(test.space(), problem);
  EXPECT_EQ(first.parameters, again.parameters);
  EXPECT_EQ(first.profiles[0].achieved, again.profiles[0].achieved);
}

TEST(InverseDesign, StopsWhenItIsTold) {
  const TestSpace test(3, 14);
  const DesignProblem problem{{target_of(test, test.at({0.1, 0.5, 0.6}), Task::poisson)}, {}, {}};
  const CancellationToken token;
  token.request(StopReason::cancelled);
  expect_error("job.cancelled", [&] { find_design(test.space(), problem, {}, {.cancellation = token}); });
}

TEST(InverseDesign, NamesTheParameterThatIsWrong) {
  const TestSpace test(2, 15);
  DesignProblem problem{{target_of(test, test.at({0.5, 0.5}), Task::stress_strain)}, Eigen::VectorXd::Zero(3), {}};
  const auto find = [&] { find_design(test.space(), problem); };
  EXPECT_EQ(places(expect_error("design.parameter_count", find)), std::vector<std::string>{"initial"});
  problem.initial = vector_of(test.at({0.5, 1.5}));
  EXPECT_EQ(places(expect_error("design.parameter_out_of_bounds", find)), std::vector<std::string>{"initial/1"});
  problem.initial.reset();
  problem.fixed = {test.at({-1, 0})[0], std::nullopt};
  EXPECT_EQ(places(expect_error("design.parameter_out_of_bounds", find)), std::vector<std::string>{"fixed/0"});
  problem.fixed.resize(1);
  EXPECT_EQ(places(expect_error("design.parameter_count", find)), std::vector<std::string>{"fixed"});
}

}  // namespace
}  // namespace supple::design
