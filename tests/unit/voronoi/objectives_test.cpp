#include "objectives.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <memory>

#include "supple/numerics/system.h"
#include "supple/voronoi/optimization.h"
#include "support/expect_error.h"
#include "support/shapes.h"

namespace supple::voronoi {
namespace {

using surface::GeodesicSolver;
using surface::TriangleMesh;

constexpr RequiredQuantities everything{true, true, true, true};

/// The derivative of a term along a random direction, by its gradient and by central differences.
struct Compared {
  double analytic;
  double numeric;
};
template <typename MakeTerm>
Compared compare(const TriangleMesh& mesh, int sites, std::uint64_t seed, const MakeTerm& make, double step) {
  const GeodesicSolver solver(testing::share(mesh));
  const auto evaluator = std::make_shared<const DiagramEvaluator>(solver, everything);
  const auto term = make(evaluator);
  SitesState state(solver.mesh(), random_sites(mesh, sites, seed));
  evaluator->evaluate(state, 1, {});
  numerics::EnergySum sum;
  sum.clear(state.dimension(), 1);
  term->add(state, 1, sum);
  RandomStream random("direction", seed);
  Eigen::VectorXd direction(state.dimension());
  for (double& x : direction) x = random.normal();
  direction.normalize();
  const auto value = [&](double along) {
    SitesState moved = state;
    moved.move(along * direction);
    evaluator->evaluate(moved, 0, {});
    numerics::EnergySum other;
    other.clear(moved.dimension(), 0);
    term->add(moved, 0, other);
    return other.value;
  };
  return {sum.gradient.dot(direction), (value(step) - value(-step)) / (2 * step)};
}

template <typename MakeTerm>
void expect_gradient(const MakeTerm& make, double tolerance = 1e-5) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    for (const auto& [mesh, sites] : {std::pair(testing::icosphere(2), 25),
                                      {testing::torus(20, 10), 40},
                                      {testing::genus3(2), 60},
                                      {testing::saddle(6), 20}}) {
      const Compared found = compare(mesh, sites, seed, make, 1e-6);
      EXPECT_NEAR(found.analytic, found.numeric, tolerance * std::max(1.0, std::abs(found.numeric)))
          << mesh.face_count() << " faces, seed " << seed;
    }
  }
}

using Evaluator = std::shared_ptr<const DiagramEvaluator>;

TEST(DiagramTerms, EdgeLengthHasItsGradient) {
  expect_gradient([](const Evaluator& evaluator) { return std::make_shared<EdgeLengthTerm>(evaluator, 1, 0.5, 0.3); });
}
TEST(DiagramTerms, PlanarityHasItsGradient) {
  expect_gradient([](const Evaluator& evaluator) { return std::make_shared<PlanarityTerm>(evaluator, 1, 0.5); });
}
TEST(DiagramTerms, RegularityHasItsGradient) {
  expect_gradient([](const Evaluator& evaluator) { return std::make_shared<RegularityTerm>(evaluator, 1, 0.5); });
}
TEST(DiagramTerms, CentroidalHasItsGradient) {
  expect_gradient([](const Evaluator& evaluator) { return std::make_shared<CentroidalTerm>(evaluator, 1, 0.5); }, 1e-6);
}
TEST(DiagramTerms, EqualAreaHasItsGradient) {
  expect_gradient([](const Evaluator& evaluator) { return std::make_shared<EqualAreaTerm>(evaluator, 1, 0.5); });
}

Optimization optimized(const OptimizationOptions& options, int sites = 30) {
  const GeodesicSolver solver(testing::share(testing::icosphere(2)));
  return optimize(solver, random_sites(solver.mesh(), sites, 1), options);
}

TEST(Optimization, MakesAreasEqualInAFewSteps) {
  OptimizationOptions options;
  options.weights.equal_area = 1;
  const Optimization result = optimized(options);
  EXPECT_EQ(result.stopped, OptimizationTermination::converged);
  EXPECT_LE(result.gradient_norm, result.gradient_tolerance);
  EXPECT_LE(result.iterations, 20);
  EXPECT_GT(result.before.area.deviation, 0.01);
  EXPECT_LT(result.after.area.deviation, 1e-6);
}

TEST(Optimization, LowersEveryObjectiveByEitherMethod) {
  for (const OptimizationMethod method : {OptimizationMethod::gauss_newton, OptimizationMethod::lbfgs}) {
    for (int objective = 0; objective < 5; ++objective) {
      OptimizationOptions options;
      double* weights[] = {&options.weights.edge_length, &options.weights.planarity, &options.weights.regularity,
                           &options.weights.centroidal, &options.weights.equal_area};
      *weights[objective] = 2;
      options.method = method;
      options.max_iterations = 6;
      const Optimization result = optimized(options);
      ASSERT_EQ(result.terms.size(), 1U);
      EXPECT_NEAR(result.terms[0].energy, result.energy, 1e-9 * result.energy);
      EXPECT_LT(result.energy, 0.999 * result.history.front().energy) << result.terms[0].name;
      EXPECT_EQ(result.history.size(), static_cast<std::size_t>(result.iterations) + 1);
      for (std::size_t i = 1; i < result.history.size(); ++i)
        EXPECT_LE(result.history[i].energy, result.history[i - 1].energy * (1 + 1e-12));
    }
  }
}

TEST(Optimization, ImprovesWhatItIsAskedFor) {
  OptimizationOptions options;
  options.method = OptimizationMethod::lbfgs;
  options.max_iterations = 60;
  options.weights.edge_length = 1;
  const Optimization lengths = optimized(options);
  EXPECT_LT(lengths.after.edge_length.deviation, 0.5 * lengths.before.edge_length.deviation);
  options.weights = {.planarity = 1};
  const Optimization planar = optimized(options);
  EXPECT_LT(planar.after.planarity.mean, 0.4 * planar.before.planarity.mean);
  options.weights = {.regularity = 1};
  const Optimization regular = optimized(options);
  EXPECT_LT(regular.after.vertex_distance.deviation, 0.85 * regular.before.vertex_distance.deviation);
}

TEST(Optimization, HoldsFixedSitesAndCountsEverySearchStep) {
  OptimizationOptions options;
  options.weights.centroidal = 1;
  options.fixed_sites = {3, 7};
  options.max_iterations = 5;
  int seen = 0;
  std::size_t cells = 0;
  options.observer = [&](const OptimizationStep& step, const Diagram& diagram) {
    ++seen;
    cells = diagram.cells.size();
    EXPECT_GT(step.energy, 0);
  };
  const Optimization result = optimized(options);
  EXPECT_EQ(seen, result.iterations + 1);
  EXPECT_EQ(cells, 30U);
  const auto start = random_sites(testing::icosphere(2), 30, 1);
  for (std::size_t i = 0; i < start.size(); ++i) {
    const bool moved = start[i].face != result.diagram.sites[i].face ||
                       (start[i].barycentric - result.diagram.sites[i].barycentric).norm() > 1e-9;
    EXPECT_EQ(moved, i != 3 && i != 7) << i;
  }
}

TEST(Optimization, EndsForgottenWorkAtOnce) {
  const GeodesicSolver solver(testing::share(testing::icosphere(2)));
  OptimizationOptions options;
  options.weights.regularity = 1;
  const CancellationToken token;
  options.observer = [&](const OptimizationStep&, const Diagram&) { token.request(StopReason::cancelled); };
  testing::expect_cancelled(StopReason::cancelled, [&] {
    optimize(solver, random_sites(solver.mesh(), 30, 1), options, {.cancellation = token});
  });
}

TEST(Optimization, AnswersWithItsBestStateIfTimeOrMemoryRunsOut) {
  const GeodesicSolver solver(testing::share(testing::icosphere(2)));
  const auto sites = random_sites(solver.mesh(), 30, 1);
  OptimizationOptions options;
  options.weights = {.edge_length = 1, .centroidal = 1};
  options.max_iterations = 4;
  const Optimization whole = optimize(solver, sites, options);
  ASSERT_EQ(whole.history.size(), 5U);
  options.max_iterations = 100;
  for (const StopReason reason : {StopReason::deadline, StopReason::memory}) {
    const CancellationToken token;
    int states = 0;
    options.observer = [&](const OptimizationStep&, const Diagram&) {
      if (++states == 5) token.request(reason);
    };
    const Optimization best = optimize(solver, sites, options, {.cancellation = token});
    const bool is_late = reason == StopReason::deadline;
    EXPECT_EQ(best.stopped, is_late ? OptimizationTermination::deadline : OptimizationTermination::memory);
    EXPECT_EQ(best.iterations, 4);
    EXPECT_EQ(best.history.size(), 5U);
    EXPECT_EQ(best.energy, whole.energy);
    EXPECT_EQ(best.gradient_norm, whole.gradient_norm);
    double terms = 0;
    for (const auto& term : best.terms) terms += term.energy;
    EXPECT_NEAR(terms, best.energy, 1e-12 * best.energy);
    EXPECT_EQ(best.after.edge_length.mean, whole.after.edge_length.mean);
    ASSERT_EQ(best.diagram.sites.size(), whole.diagram.sites.size());
    for (std::size_t i = 0; i < sites.size(); ++i)
      EXPECT_EQ(best.diagram.sites[i].barycentric, whole.diagram.sites[i].barycentric);
    ASSERT_EQ(best.diagram.warnings.size(), 1U);
    EXPECT_NE(best.diagram.warnings[0].find("after 4 iterations"), std::string::npos) << best.diagram.warnings[0];
    EXPECT_FALSE(token.requested());
  }
}

TEST(Optimization, FailsIfTimeRunsOutBeforeItsFirstState) {
  const GeodesicSolver solver(testing::share(testing::icosphere(2)));
  OptimizationOptions options;
  options.weights.regularity = 1;
  const CancellationToken token;
  token.request(StopReason::deadline);
  testing::expect_cancelled(StopReason::deadline, [&] {
    optimize(solver, random_sites(solver.mesh(), 30, 1), options, {.cancellation = token});
  });
}

TEST(Optimization, NamesWhatItRefuses) {
  const auto refused = [](const char* code, auto change) {
    OptimizationOptions options;
    options.weights.planarity = 1;
    change(options);
    const auto error = testing::expect_error(code, [&] { optimized(options); });
    return error.details().empty() ? std::string() : error.details()[0].where;
  };
  EXPECT_EQ(refused("voronoi.no_objective", [](auto& o) { o.weights.planarity = 0; }), "objectives");
  EXPECT_EQ(refused("voronoi.invalid_option", [](auto& o) { o.weights.equal_area = -1; }), "objectives/equal_area");
  EXPECT_EQ(refused("voronoi.invalid_option", [](auto& o) { o.tolerance = 0; }), "tolerance");
  EXPECT_EQ(refused("voronoi.invalid_option", [](auto& o) { o.max_iterations = max_optimization_iterations + 1; }),
            "max_iterations");
  EXPECT_EQ(refused("voronoi.invalid_option", [](auto& o) { o.edge_length = -1; }), "edge_length");
  EXPECT_EQ(refused("voronoi.fixed_site", [](auto& o) { o.fixed_sites = {2, 30}; }), "fixed_sites/1");
}

TEST(Optimization, MakesDiagramsAnewOnlyRoundTheSitesThatAreNotHeld) {
  const TriangleMesh mesh = testing::icosphere(2);
  const GeodesicSolver solver(testing::share(mesh));
  OptimizationOptions options;
  options.weights = {.edge_length = 1, .centroidal = 1, .equal_area = 1};
  options.max_iterations = 8;
  for (std::int32_t site = 3; site < 40; ++site) options.fixed_sites.push_back(site);
  CostLedger cost;
  const Optimization result = optimize(solver, random_sites(mesh, 40, 1), options, {.cost = &cost});
  double local = 0;
  for (const auto& quantity : cost.quantities())
    if (quantity.name == "local_rebuilds") local = quantity.value;
  EXPECT_GE(local, result.iterations);
  EXPECT_GE(result.iterations, 3);
  options.max_iterations = 0;
  const Optimization anew = optimize(solver, result.diagram.sites, options);
  EXPECT_LT(result.energy, result.history.front().energy);
  ASSERT_EQ(anew.diagram.cells.size(), result.diagram.cells.size());
  for (std::size_t i = 0; i < anew.diagram.cells.size(); ++i)
    EXPECT_NEAR(anew.diagram.cells[i].area, result.diagram.cells[i].area, 1e-12);
  ASSERT_EQ(anew.diagram.cell_moments.size(), result.diagram.cell_moments.size());
  for (std::size_t i = 0; i < anew.diagram.cell_moments.size(); ++i)
    EXPECT_NEAR(anew.diagram.cell_moments[i].squared_distance, result.diagram.cell_moments[i].squared_distance, 1e-12);
}

}  // namespace
}  // namespace supple::voronoi
