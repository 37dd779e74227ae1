#include "supple/design/inverse_design.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <numbers>

#include "supple/design/design_fault.h"
#include "support/expect_error.h"
#include "test_space.h"

namespace supple::design {
namespace {

using supple::testing::expect_error;
using supple::testing::places;

using std::numbers::pi;

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
  // No design is closer among many random ones.
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
  EXPECT_EQ(held.stopped, DesignTermination::no_free_parameters);
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
  expect_error<NoDesign>("design.no_equilibrium", [&] { find_design(nowhere, problem, {.candidates = 3}); });
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
  EXPECT_EQ(design.stopped, DesignTermination::reached);
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

TEST(InverseDesign, ReportsAProgressThatGrowsAndStaysBelowTheEnd) {
  struct Sink : ProgressSink {
    std::vector<double> fractions;
    void report(double fraction, std::string_view stage) override {
      if (stage == "optimization") fractions.push_back(fraction);
    }
  } sink;
  const TestSpace test(2, 12);
  DesignProblem problem{
      {target_of(test, test.at({0.2, 0.8}), Task::stress_strain)}, vector_of(test.at({0.8, 0.2})), {}};
  find_design(test.space(), problem, {}, {.progress = &sink});
  ASSERT_GE(sink.fractions.size(), 2U);
  EXPECT_TRUE(std::is_sorted(sink.fractions.begin(), sink.fractions.end()));
  EXPECT_GE(sink.fractions.front(), 0);
  EXPECT_GT(sink.fractions.back(), sink.fractions.front());
  EXPECT_LT(sink.fractions.back(), 1);
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

TEST(InverseDesign, ReachesATargetThatItMissesWithoutWeightOnly) {
  const TestSpace test(2, 9);
  auto target = target_of(test, test.at({0.2, 0.7}), Task::stress_strain);
  const double before = target.control_points[8][1];
  target.interpolation = numerics::Interpolation::linear;
  target.weights.assign(target.control_points.size(), 1);
  target.control_points[8][1] *= 3;
  target.weights[8] = 0;
  const auto design = find_design(test.space(), {{target}, {}, {}});
  EXPECT_TRUE(design.reached);
  EXPECT_EQ(design.message, "");
  EXPECT_FALSE(design.profiles[0].reached[8]) << "the flags are those of all samples";
  EXPECT_LT(design.error.max, 0.1 * std::abs(before));
}

TEST(InverseDesign, NamesTheParameterThatIsWrong) {
  const TestSpace test(2, 15);
  DesignProblem problem{{target_of(test, test.at({0.5, 0.5}), Task::stress_strain)}, Eigen::VectorXd::Zero(3), {}};
  const auto find = [&] { find_design(test.space(), problem); };
  EXPECT_EQ(places(expect_error<DesignFault>("design.parameter_count", find)), std::vector<std::string>{"initial"});
  problem.initial = vector_of(test.at({0.5, 1.5}));
  EXPECT_EQ(places(expect_error<DesignFault>("design.parameter_out_of_bounds", find)),
            std::vector<std::string>{"initial/1"});
  problem.initial.reset();
  problem.fixed = {test.at({-1, 0})[0], std::nullopt};
  EXPECT_EQ(places(expect_error<DesignFault>("design.parameter_out_of_bounds", find)),
            std::vector<std::string>{"fixed/0"});
  problem.fixed.resize(1);
  EXPECT_EQ(places(expect_error<DesignFault>("design.parameter_count", find)), std::vector<std::string>{"fixed"});
}

/// A target that the given parameters meet with `factor` times the modulus of the model.
Target stiffer_target_of(const TestSpace& test, const std::vector<double>& parameters, Task task, double factor) {
  Target target = target_of(test, parameters, task);
  if (task != Task::poisson)
    for (auto& point : target.control_points) point[1] *= factor;
  return target;
}

TEST_P(EveryTask, FindsTheSameParametersForAnotherModulus) {
  const TestSpace test(2, 1);
  const auto parameters = test.at({0.37, 0.72});
  const double model_modulus = test.model.provenance.youngs_modulus;
  const auto plain = find_design(test.space(), {{target_of(test, parameters, GetParam())}, {}, {}});
  EXPECT_EQ(plain.youngs_modulus, model_modulus);
  DesignProblem problem{{stiffer_target_of(test, parameters, GetParam(), 40)}, {}, {}};
  problem.moduli = {{40 * model_modulus, 40 * model_modulus}};
  const auto stiffer = find_design(test.space(), problem);
  EXPECT_TRUE(stiffer.reached);
  EXPECT_EQ(stiffer.youngs_modulus, 40 * model_modulus);
  EXPECT_LT((stiffer.parameters - plain.parameters).norm(), 1e-4);
  const double factor = GetParam() == Task::poisson ? 1 : 40;
  EXPECT_LT((stiffer.profiles[0].achieved - factor * plain.profiles[0].achieved).norm(),
            1e-3 * factor * plain.profiles[0].achieved.norm());
  EXPECT_LT((stiffer.profiles[0].highest - factor * plain.profiles[0].highest).norm(),
            1e-9 * factor * plain.profiles[0].highest.norm());
}

TEST(InverseDesign, FindsTheModulusWithTheParameters) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const TestSpace test(2, seed);
    const double model_modulus = test.model.provenance.youngs_modulus;
    // Stiffness depends on the direction, so that other parameters cannot replace another modulus.
    DesignProblem problem{{stiffer_target_of(test, test.at({0.37, 0.72}), Task::stiffness, 7)}, {}, {}};
    problem.moduli = {{model_modulus, 100 * model_modulus}};
    const auto design = find_design(test.space(), problem);
    EXPECT_LT(design.error.relative_rms, 1e-3) << seed;
    const auto found = std::vector<double>(design.parameters.begin(), design.parameters.end());
    const auto& profile = design.profiles[0];
    const auto of_model = evaluate_profile(test.model, test.evaluator, found, profile.target.samples);
    EXPECT_LT((profile.achieved - design.youngs_modulus / model_modulus * of_model.y).norm(),
              1e-9 * profile.achieved.norm());
    // The target is out of reach with the model's own modulus.
    DesignProblem held = problem;
    held.moduli.clear();
    EXPECT_GT(find_design(test.space(), held).error.relative_rms, 0.05) << seed;
  }
}

TEST(InverseDesign, ChoosesAmongMaterials) {
  const TestSpace test(2, 1);
  const double model_modulus = test.model.provenance.youngs_modulus;
  DesignProblem problem{{stiffer_target_of(test, test.at({0.37, 0.72}), Task::stress_strain, 7)}, {}, {}};
  problem.moduli = {{model_modulus, model_modulus},
                    {200 * model_modulus, 300 * model_modulus},
                    {6.5 * model_modulus, 8 * model_modulus}};
  const auto design = find_design(test.space(), problem);
  EXPECT_EQ(design.material, 2U);
  EXPECT_TRUE(design.reached);
}

TEST(InverseDesign, IsOfNoWorseMaterialThanEachOneAlone) {
  int unreached = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 9U}) {
    const TestSpace test(2, seed);
    const double model_modulus = test.model.provenance.youngs_modulus;
    // No design follows this curve: every second point is moved.
    DesignProblem problem{{stiffer_target_of(test, test.at({0.37, 0.72}), Task::stress_strain, 2)}, {}, {}};
    auto& points = problem.targets[0].control_points;
    for (std::size_t i = 1; i < points.size(); ++i) points[i][1] *= i % 2 == 0 ? 1.15 : 0.7;
    const std::vector<Range> moduli = {{0.2 * model_modulus, 0.6 * model_modulus},
                                       {1.2 * model_modulus, 1.2 * model_modulus},
                                       {2.5 * model_modulus, 16 * model_modulus}};
    double best_alone = INFINITY, lowest = INFINITY, highest = -INFINITY;
    for (const Range& range : moduli) {
      problem.moduli = {range};
      const auto design = find_design(test.space(), problem);
      best_alone = std::min(best_alone, design.error.relative_rms);
      lowest = std::min(lowest, design.profiles[0].lowest.minCoeff());
      highest = std::max(highest, design.profiles[0].highest.maxCoeff());
    }
    problem.moduli = moduli;
    const auto design = find_design(test.space(), problem);
    EXPECT_LE(design.error.relative_rms, std::max((1 + 1e-9) * best_alone, 1e-3)) << seed;
    EXPECT_DOUBLE_EQ(design.profiles[0].lowest.minCoeff(), lowest) << "of all materials";
    EXPECT_DOUBLE_EQ(design.profiles[0].highest.maxCoeff(), highest);
    const auto [least, most] = moduli.at(design.material);
    EXPECT_TRUE(design.youngs_modulus >= least && design.youngs_modulus <= most);
    unreached += best_alone > 1e-3 ? 1 : 0;
  }
  EXPECT_GT(unreached, 0) << "all materials are searched for where none reaches the target";
}

/// A target that structures meet if they are turned by this angle.
Target turned_target_of(const TestSpace& test, const std::vector<double>& parameters, Task task, double orientation) {
  Target target = target_of(test, parameters, task);
  ProfileSamples samples{task, target.direction, target.strain, StrainMeasure::green, {}, orientation};
  for (const auto& point : target.control_points) samples.x.push_back(point[0]);
  const auto profile = evaluate_profile(test.model, test.evaluator, parameters, samples);
  for (std::size_t i = 0; i < samples.x.size(); ++i)
    target.control_points[i][1] = profile.y[static_cast<Eigen::Index>(i)];
  return target;
}

TEST_P(EveryTask, FindsTheSameParametersForATurnedTarget) {
  const TestSpace test(2, 1);
  const auto parameters = test.at({0.37, 0.72});
  DesignProblem problem{{turned_target_of(test, parameters, GetParam(), 0.6)}, {}, {}};
  EXPECT_GT(find_design(test.space(), problem).error.relative_rms, 1e-3) << "another target, for the tiling as it is";
  problem.orientation = {0.6, 0.6};
  const auto turned = find_design(test.space(), problem);
  EXPECT_EQ(turned.orientation, 0.6);
  EXPECT_TRUE(turned.reached);
  // Several designs have the same curve along one direction.
  if (GetParam() != Task::stress_strain) {
    EXPECT_LT((turned.parameters - vector_of(parameters)).norm(), 1e-2);
  }
  // The answer's samples have its orientation, so that its profile can be computed again.
  const std::vector<double> found(turned.parameters.begin(), turned.parameters.end());
  const auto& profile = turned.profiles[0];
  EXPECT_LT((profile.achieved - evaluate_profile(test.model, test.evaluator, found, profile.target.samples).y).norm(),
            1e-8 * profile.achieved.norm());
}

TEST_P(EveryTask, FindsTheOrientationWithTheParameters) {
  for (const double orientation : {0.2, 1.4, 2.9}) {
    const TestSpace test(2, 2);
    DesignProblem problem{{turned_target_of(test, test.at({0.37, 0.72}), GetParam(), orientation)}, {}, {}};
    problem.orientation = {0, pi};
    const auto design = find_design(test.space(), problem);
    EXPECT_LT(design.error.relative_rms, 1e-3) << orientation;
    EXPECT_GE(design.orientation, 0);
    EXPECT_LE(design.orientation, pi);
    EXPECT_TRUE((design.profiles[0].lowest.array() <= design.profiles[0].achieved.array()).all());
  }
}

TEST(InverseDesign, TurnsADesignWhoseParametersAreHeld) {
  const TestSpace test(2, 2);
  const auto parameters = test.at({0.37, 0.72});
  DesignProblem problem{{turned_target_of(test, parameters, Task::stiffness, 1.1)}, {}, {}};
  problem.orientation = {0.5, 1.5};
  problem.fixed = {parameters[0], parameters[1]};
  const auto design = find_design(test.space(), problem);
  EXPECT_NEAR(design.orientation, 1.1, 1e-4);
  EXPECT_EQ(design.parameters, vector_of(parameters));
  // With a given initial orientation there is only one starting point.
  problem.fixed.clear();
  problem.initial = vector_of(parameters);
  problem.initial_orientation = 1.05;
  const auto followed = find_design(test.space(), problem);
  EXPECT_EQ(followed.starts, 1);
  EXPECT_NEAR(followed.orientation, 1.1, 1e-3);
}

/// Relative density is the first parameter's fraction of its bounds.
DesignSpace measured(const TestSpace& test) {
  auto space = test.space();
  space.measure = [&network = test.model.network](const Eigen::VectorXd& parameters) -> StructureMeasures {
    return {(parameters[0] - network.lower[0]) / (network.upper[0] - network.lower[0]), 10};
  };
  return space;
}

TEST(InverseDesign, KeepsWithinLimits) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const TestSpace test(2, seed);
    const auto space = measured(test);
    DesignProblem problem{{target_of(test, test.at({0.7, 0.4}), Task::stiffness)}, {}, {}};
    const double free = space.measure(find_design(space, problem).parameters).relative_density;
    EXPECT_NEAR(free, 0.7, 0.05) << seed;
    problem.limits.relative_density.most = 0.5;
    const auto limited = find_design(space, problem);
    const double density = space.measure(limited.parameters).relative_density;
    EXPECT_LE(density, 0.5) << seed;
    // The best design within the limits is known from a search over a grid.
    double best = limited.error.relative_rms;
    const auto sampled = sample_target(problem.targets[0]);
    for (int i = 0; i <= 20; ++i)
      for (int k = 0; k <= 40; ++k) {
        const auto profile =
            evaluate_profile(test.model, test.evaluator, test.at({0.025 * i, 0.025 * k}), sampled.samples);
        best = std::min(best, sampled.relative_rms(profile.y).value_or(1));
      }
    EXPECT_LE(limited.error.relative_rms, 1.05 * best) << seed << ", density " << density;
  }
}

TEST(InverseDesign, SaysThatNothingKeepsWithinTheLimits) {
  const TestSpace test(2, 1);
  DesignProblem problem{{target_of(test, test.at({0.7, 0.4}), Task::stiffness)}, {}, {}};
  problem.limits.relative_density = {1.5, 2};
  const auto error = expect_error<BeyondLimits>("design.beyond_limits", [&] { find_design(measured(test), problem); });
  EXPECT_NE(std::string(error.what()).find("below the least one asked for, 1.5"), std::string::npos) << error.what();
  EXPECT_EQ(places(error), std::vector<std::string>{"limits"});
  const DesignSpace spaces[] = {measured(test), measured(test)};
  const auto of_all = expect_error<BeyondLimits>("design.beyond_limits", [&] { find_designs(spaces, problem); });
  EXPECT_TRUE(std::string(of_all.what()).starts_with("No design of any family")) << of_all.what();
  EXPECT_NE(std::string(of_all.what()).find("below the least one asked for, 1.5"), std::string::npos);
}

}  // namespace
}  // namespace supple::design
