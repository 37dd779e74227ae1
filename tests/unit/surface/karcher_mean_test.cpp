#include "supple/surface/karcher_mean.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "supple/base/error.h"
#include "supple/surface/exponential_map.h"
#include "support/expect_error.h"
#include "support/nearest_point.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using testing::expect_cancelled;
using testing::expect_error;
using testing::nearest_point;
using testing::places;

constexpr MinimizationMethod all_methods[] = {MinimizationMethod::newton, MinimizationMethod::lbfgs,
                                              MinimizationMethod::gradient_descent};

struct Scene {
  explicit Scene(TriangleMesh built) : mesh(std::make_shared<const TriangleMesh>(std::move(built))), solver(mesh) {}
  std::shared_ptr<const TriangleMesh> mesh;
  GeodesicSolver solver;
};

KarcherProblem random_problem(const TriangleMesh& mesh, int points, std::uint64_t seed) {
  RandomStream random("karcher_mean_test", seed);
  KarcherProblem problem;
  for (int i = 0; i < points; ++i) problem.points.push_back(testing::random_point(mesh, random));
  return problem;
}

double objective_at(const GeodesicSolver& solver, const KarcherProblem& problem, const SurfacePoint& p) {
  double sum = 0;
  double weights = 0;
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    const double w = problem.weights.empty() ? 1 : problem.weights[i];
    const double g = solver.distance(problem.points[i], p);
    sum += w * g * g;
    weights += w;
  }
  return sum / (2 * weights);
}

TEST(KarcherMean, OfPointsOfAPlaneIsTheirWeightedCentroid) {
  Scene scene(testing::flat_grid(12, 9));
  RandomStream random("karcher_plane", 1);
  for (const MinimizationMethod method : all_methods) {
    for (int trial = 0; trial < 10; ++trial) {
      KarcherProblem problem = random_problem(*scene.mesh, 7, trial);
      problem.method = method;
      Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
      double sum = 0;
      for (const SurfacePoint& point : problem.points) {
        problem.weights.push_back(random.uniform(0.1, 3));
        centroid += problem.weights.back() * position(*scene.mesh, point);
        sum += problem.weights.back();
      }
      const KarcherMean mean = karcher_mean(scene.solver, problem);
      EXPECT_EQ(mean.stopped, KarcherTermination::converged);
      EXPECT_LT((mean.position - centroid / sum).norm(), 1e-9);
      EXPECT_LE(mean.iterations, 2) << "on a plane the objective is one quadratic function";
    }
  }
}

TEST(KarcherMean, OfOnePointIsThePoint) {
  Scene scene(testing::icosphere(2));
  const KarcherProblem problem = random_problem(*scene.mesh, 1, 3);
  const KarcherMean mean = karcher_mean(scene.solver, problem);
  EXPECT_EQ(mean.stopped, KarcherTermination::converged);
  EXPECT_EQ(mean.iterations, 0);
  EXPECT_EQ(mean.objective, 0);
  EXPECT_LT((mean.position - position(*scene.mesh, problem.points[0])).norm(), 1e-15);
}

TEST(KarcherMean, OfTwoPointsDividesTheirGeodesicByTheWeights) {
  Scene scene(testing::torus());
  for (int trial = 0; trial < 20; ++trial) {
    KarcherProblem problem = random_problem(*scene.mesh, 2, 100 + trial);
    problem.weights = {3, 1};
    const double whole = scene.solver.distance(problem.points[0], problem.points[1]);
    const KarcherMean mean = karcher_mean(scene.solver, problem);
    EXPECT_LE(mean.gradient_norm, 1e-9 * scene.mesh->diagonal());
    EXPECT_NEAR(scene.solver.distance(problem.points[0], mean.mean), whole / 4, 1e-8);
    EXPECT_NEAR(scene.solver.distance(problem.points[1], mean.mean), whole * 3 / 4, 1e-8);
  }
}

TEST(KarcherMean, OfFiveRandomPointsOnASphereConvergesEveryTime) {
  Scene scene(testing::icosphere(3));
  for (int trial = 0; trial < 100; ++trial) {
    const KarcherProblem problem = random_problem(*scene.mesh, 5, trial);
    const KarcherMean mean = karcher_mean(scene.solver, problem);
    EXPECT_EQ(mean.stopped, KarcherTermination::converged) << trial;
    EXPECT_LE(mean.gradient_norm, 1e-9 * scene.mesh->diagonal()) << trial;
    EXPECT_NEAR(mean.objective, objective_at(scene.solver, problem, mean.mean), 1e-12) << trial;
  }
}

TEST(KarcherMean, IsALocalMinimumOfTheObjective) {
  Scene scene(testing::genus3());
  for (int trial = 0; trial < 10; ++trial) {
    const KarcherProblem problem = random_problem(*scene.mesh, 6, trial);
    const KarcherMean mean = karcher_mean(scene.solver, problem);
    const auto frame = tangent_frame(*scene.mesh, mean.mean.face);
    for (int k = 0; k < 12; ++k) {
      const Eigen::Vector3d tangent = 1e-4 * (frame * Eigen::Vector2d(std::cos(k), std::sin(k)));
      const SurfacePoint beside = exponential_map(*scene.mesh, mean.mean, tangent, {}).end;
      EXPECT_GT(objective_at(scene.solver, problem, beside), mean.objective) << trial;
    }
  }
}

TEST(KarcherMean, IsTheSameByEveryMethodFromTheSameStartNearIt) {
  Scene scene(testing::icosphere(3));
  for (int trial = 0; trial < 10; ++trial) {
    KarcherProblem problem = random_problem(*scene.mesh, 5, trial);
    const KarcherMean newton = karcher_mean(scene.solver, problem);
    problem.start = newton.mean;
    for (const MinimizationMethod method : all_methods) {
      problem.method = method;
      const KarcherMean other = karcher_mean(scene.solver, problem);
      EXPECT_EQ(other.stopped, KarcherTermination::converged);
      EXPECT_LT((other.position - newton.position).norm(), 1e-8);
    }
  }
}

TEST(KarcherMean, HistoryStartsAtTheStartAndItsObjectiveNeverRises) {
  Scene scene(testing::torus());
  KarcherProblem problem = random_problem(*scene.mesh, 6, 5);
  problem.start = testing::nearest_point(*scene.mesh, {-1.4, 0, 0.05});
  for (const MinimizationMethod method : all_methods) {
    problem.method = method;
    const KarcherMean mean = karcher_mean(scene.solver, problem);
    ASSERT_EQ(mean.history.size(), static_cast<std::size_t>(mean.iterations) + 1);
    EXPECT_NEAR(mean.history.front().objective, objective_at(scene.solver, problem, *problem.start), 1e-12);
    EXPECT_EQ(mean.history.front().step_length, 0);
    EXPECT_EQ(mean.history.back().gradient_norm, mean.gradient_norm);
    for (std::size_t i = 1; i < mean.history.size(); ++i) {
      EXPECT_LE(mean.history[i].objective, mean.history[i - 1].objective * (1 + 1e-13));
      EXPECT_GT(mean.history[i].step_length, 0);
    }
  }
}

TEST(KarcherMean, DoesNotDependOnTheScaleOfTheWeights) {
  Scene scene(testing::icosphere(2));
  KarcherProblem problem = random_problem(*scene.mesh, 4, 8);
  problem.weights = {1, 2, 3, 4};
  const KarcherMean mean = karcher_mean(scene.solver, problem);
  for (const double scale : {1e-300, 1e300}) {
    for (std::size_t i = 0; i < 4; ++i) problem.weights[i] = scale * static_cast<double>(i + 1);
    const KarcherMean scaled = karcher_mean(scene.solver, problem);
    EXPECT_NEAR(scaled.objective, mean.objective, 1e-12);
    EXPECT_LT((scaled.position - mean.position).norm(), 1e-9);
  }
}

TEST(KarcherMean, PointsOfWeightZeroDoNotCount) {
  Scene scene(testing::icosphere(2));
  KarcherProblem problem = random_problem(*scene.mesh, 4, 9);
  const KarcherMean mean = karcher_mean(scene.solver, problem);
  problem.weights = {1, 1, 1, 1, 0};
  problem.points.push_back(testing::nearest_point(*scene.mesh, {0, 0, -1}));
  EXPECT_LT((karcher_mean(scene.solver, problem).position - mean.position).norm(), 1e-12);
}

TEST(KarcherMean, KeptFieldsGiveTheSameMeanAndTheBillSaysWhetherTheyWereUsed) {
  Scene scene(testing::genus3());
  using KeptFields = KarcherProblem::KeptFields;
  for (int trial = 0; trial < 5; ++trial) {
    KarcherProblem problem = random_problem(*scene.mesh, 5, 20 + trial);
    Eigen::Vector3d first = Eigen::Vector3d::Zero();
    for (const KeptFields choice : {KeptFields::off, KeptFields::on, KeptFields::automatic}) {
      problem.kept_fields = choice;
      CostLedger cost;
      Execution execution;
      execution.cost = &cost;
      const KarcherMean mean = karcher_mean(scene.solver, problem, execution);
      EXPECT_LE(mean.gradient_norm, 1e-9 * scene.mesh->diagonal());
      ASSERT_EQ(cost.effects().size(), 3u);
      EXPECT_EQ(cost.effects()[0].name, "kept_fields");
      EXPECT_EQ(cost.effects()[1].name, "guided_searches");
      EXPECT_FALSE(cost.effects()[1].ran) << "the shape does not wind";
      EXPECT_FALSE(cost.effects()[0].why.empty());
      if (choice == KeptFields::off) first = mean.position;
      EXPECT_LT((mean.position - first).norm(), 1e-7);
      if (choice == KeptFields::off) {
        EXPECT_FALSE(cost.effects()[0].ran);
      }
      if (choice == KeptFields::on) {
        EXPECT_TRUE(cost.effects()[0].ran);
        EXPECT_EQ(cost.effects()[0].count, 5);
      }
    }
  }
}

TEST(KarcherMean, OnAShapeThatWindsIsFoundByGuidedSearches) {
  Scene scene(testing::spiral_cup(400, 12));
  for (int trial = 0; trial < 3; ++trial) {
    KarcherProblem problem = random_problem(*scene.mesh, 5, 40 + trial);
    CostLedger cost;
    const KarcherMean mean = karcher_mean(scene.solver, problem, {.cost = &cost});
    EXPECT_LE(mean.gradient_norm, 1e-9 * scene.mesh->diagonal());
    ASSERT_EQ(cost.effects().size(), 3u);
    EXPECT_TRUE(cost.effects()[1].ran);
    // The same minimum as from the same place by kept fields.
    problem.kept_fields = KarcherProblem::KeptFields::on;
    problem.start = mean.mean;
    EXPECT_LT((karcher_mean(scene.solver, problem).position - mean.position).norm(), 1e-7);
  }
}

TEST(KarcherMean, SeveralStartsFindLowerMeans) {
  Scene scene(testing::torus());
  int lower = 0;
  for (int trial = 0; trial < 20; ++trial) {
    KarcherProblem problem = random_problem(*scene.mesh, 5, trial);
    const KarcherMean one = karcher_mean(scene.solver, problem);
    EXPECT_EQ(one.start, 0);
    problem.starts = 6;
    CostLedger cost;
    const KarcherMean best = karcher_mean(scene.solver, problem, {.cost = &cost});
    // With more searches another kind of search may pay, which rounds otherwise.
    const double rounding = 1e-9 * one.objective;
    EXPECT_LE(best.objective, one.objective + rounding);
    EXPECT_EQ(best.start > 0, best.objective < one.objective - rounding);
    EXPECT_NEAR(best.objective, objective_at(scene.solver, problem, best.mean), 1e-12);
    EXPECT_EQ(static_cast<int>(best.history.size()), best.iterations + 1);
    EXPECT_TRUE(cost.effects().back().name == "multi_start" && cost.effects().back().ran);
    EXPECT_EQ(cost.effects().back().count, 5);
    lower += best.objective < 0.99 * one.objective;
  }
  EXPECT_GE(lower, 2) << "of 20 random sets of 5 points on a torus";
}

TEST(KarcherMean, FurtherStartsLieOnTheComponentOfThePoints) {
  Scene scene(testing::two_components());
  KarcherProblem problem;
  problem.points = {{FaceId{0}, {0.2, 0.3, 0.5}}, {FaceId{0}, {0.6, 0.3, 0.1}}};
  problem.starts = 5;
  const KarcherMean mean = karcher_mean(scene.solver, problem);
  EXPECT_EQ(scene.mesh->component(index(mean.mean.face)), scene.mesh->component(index(problem.points[0].face)));
}

TEST(KarcherMean, OneSearchForManyPointsAgreesWithTheDefinition) {
  Scene scene(testing::torus());
  const KarcherProblem problem = random_problem(*scene.mesh, 200, 1);
  const KarcherMean mean = karcher_mean(scene.solver, problem);
  EXPECT_LE(mean.gradient_norm, 1e-9 * scene.mesh->diagonal());
  EXPECT_NEAR(mean.objective, objective_at(scene.solver, problem, mean.mean), 1e-12);
}

TEST(KarcherMean, BillsSearchDerivativesAndSteps) {
  Scene scene(testing::icosphere(3));
  CostLedger cost;
  Execution execution;
  execution.cost = &cost;
  karcher_mean(scene.solver, random_problem(*scene.mesh, 5, 0), execution);
  std::vector<std::string> names;
  for (const auto& stage : cost.stages()) names.push_back(stage.name);
  for (const char* stage : {"search", "derivatives", "step"})
    EXPECT_NE(std::find(names.begin(), names.end(), stage), names.end()) << stage;
  ASSERT_FALSE(cost.quantities().empty());
}

TEST(KarcherMean, LooksAroundOnlyWhereALowerPlaceCanBeNextToIt) {
  Scene scene(testing::flat_grid(12, 9));
  KarcherProblem problem = random_problem(*scene.mesh, 7, 1);
  problem.kept_fields = KarcherProblem::KeptFields::off;
  CostLedger cost;
  Execution execution;
  execution.cost = &cost;
  const KarcherMean mean = karcher_mean(scene.solver, problem, execution);
  ASSERT_EQ(mean.stopped, KarcherTermination::converged);
  const auto search = std::find_if(cost.stages().begin(), cost.stages().end(),
                                   [](const CostLedger::Stage& stage) { return stage.name == "search"; });
  ASSERT_NE(search, cost.stages().end());
  EXPECT_EQ(search->count, mean.iterations + 2) << "one for the choice of the start, one for each state";
}

TEST(KarcherMean, IsTheSameToTheLastBitOnEveryRun) {
  Scene scene(testing::bumpy_cube(22, 4));
  ASSERT_GT(scene.mesh->face_count(), 5000) << "the case should be large enough for threads";
  const KarcherProblem problem = random_problem(*scene.mesh, 5, 2);
  const KarcherMean first = karcher_mean(scene.solver, problem);
  const KarcherMean second = karcher_mean(scene.solver, problem);
  EXPECT_EQ(first.mean.barycentric, second.mean.barycentric);
  EXPECT_EQ(first.objective, second.objective);
  EXPECT_EQ(first.gradient_norm, second.gradient_norm);
}

TEST(KarcherMean, StopsAtTheIterationLimitAndSaysSo) {
  Scene scene(testing::icosphere(3));
  KarcherProblem problem = random_problem(*scene.mesh, 5, 0);
  problem.max_iterations = 1;
  const KarcherMean mean = karcher_mean(scene.solver, problem);
  EXPECT_EQ(mean.stopped, KarcherTermination::iteration_limit);
  EXPECT_EQ(mean.iterations, 1);
}

TEST(KarcherMean, StopsWhenCancelledBetweenEvaluations) {
  class CancelLater : public ProgressSink {
   public:
    explicit CancelLater(CancellationToken token) : token_(std::move(token)) {}
    void report(double, std::string_view) override {
      if (++reports == 3) token_.request(StopReason::cancelled);
    }
    int reports = 0;

   private:
    CancellationToken token_;
  };
  Scene scene(testing::icosphere(3));
  Execution execution;
  CancelLater sink(execution.cancellation);
  execution.progress = &sink;
  expect_cancelled(StopReason::cancelled,
                   [&] { karcher_mean(scene.solver, random_problem(*scene.mesh, 5, 0), execution); });
  EXPECT_EQ(sink.reports, 3);
}

TEST(KarcherMean, NamesWhatIsWrongWithThePointsAndWeights) {
  Scene scene(testing::icosphere(1));
  KarcherProblem problem;
  expect_error("karcher.no_points", [&] { karcher_mean(scene.solver, problem); });

  problem = random_problem(*scene.mesh, 3, 0);
  problem.weights = {1, 2};
  expect_error("karcher.weights", [&] { karcher_mean(scene.solver, problem); });
  problem.weights = {1, -2, std::nan("")};
  const Error signs = expect_error("karcher.weights", [&] { karcher_mean(scene.solver, problem); });
  EXPECT_EQ(places(signs), (std::vector<std::string>{"weights/1", "weights/2"}));
  problem.weights = {0, 0, 0};
  expect_error("karcher.weights", [&] { karcher_mean(scene.solver, problem); });
  problem.weights.clear();

  problem.points[1].face = FaceId{100000};
  const Error range = expect_error<PointError>("point.face_out_of_range", [&] { karcher_mean(scene.solver, problem); });
  EXPECT_EQ(places(range), (std::vector<std::string>{"points/1/face"}));

  problem = random_problem(*scene.mesh, 3, 0);
  problem.tolerance = -1;
  expect_error("karcher.invalid_option", [&] { karcher_mean(scene.solver, problem); });
  problem.tolerance = 1e-9;
  problem.max_iterations = -1;
  expect_error("karcher.invalid_option", [&] { karcher_mean(scene.solver, problem); });
  problem.max_iterations = 200;
  problem.starts = 0;
  const Error starts = expect_error("karcher.invalid_option", [&] { karcher_mean(scene.solver, problem); });
  EXPECT_EQ(places(starts), (std::vector<std::string>{"starts"}));
}

}  // namespace
}  // namespace supple::surface
