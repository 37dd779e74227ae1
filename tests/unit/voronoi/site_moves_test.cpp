// Single-site moves, where no step for all sites lowers the energy.
#include "site_moves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <set>
#include <vector>

#include "supple/voronoi/optimization.h"
#include "support/expect_error.h"
#include "support/shapes.h"

namespace supple::voronoi {
namespace {

using surface::GeodesicSolver;
using surface::TriangleMesh;

constexpr RequiredQuantities quantities_of_values{.edge_lengths = true, .cell_moments = true};

std::vector<std::shared_ptr<DiagramTerm>> every_term(const std::shared_ptr<const DiagramEvaluator>& evaluator) {
  return {std::make_shared<EdgeLengthTerm>(evaluator, 1, 0.5, 0.3), std::make_shared<PlanarityTerm>(evaluator, 2, 0.5),
          std::make_shared<RegularityTerm>(evaluator, 3, 0.5), std::make_shared<CentroidalTerm>(evaluator, 4, 0.5),
          std::make_shared<EqualAreaTerm>(evaluator, 5, 0.5)};
}

Eigen::VectorXd energies_of(const DiagramTerm& term, const SitesState& state) {
  Eigen::VectorXd energies = Eigen::VectorXd::Zero(state.dimension() / 2);
  term.add_cell_energies(state, energies);
  return energies;
}

TEST(CellEnergies, AddUpToTheEnergyAndChangeOnlyNextToASiteThatMoves) {
  for (const TriangleMesh& mesh : {testing::icosphere(2), testing::torus(24, 12), testing::saddle(6)}) {
    const GeodesicSolver solver(testing::share(mesh));
    const auto evaluator = std::make_shared<const DiagramEvaluator>(solver, quantities_of_values);
    SitesState before(solver.mesh(), random_sites(mesh, 40, 1));
    evaluator->evaluate(before, 0, {});
    Eigen::VectorXd step = Eigen::VectorXd::Zero(before.dimension());
    step.segment<2>(2 * 7) << 0.1, 0.05;
    SitesState after = before;
    after.move(step);
    evaluator->evaluate(after, 0, {});
    std::set<std::int32_t> near{7};
    for (const SitesState* state : {&before, &after}) {
      const auto& neighbours = state->evaluation()->diagram.cells[7].neighbours;
      near.insert(neighbours.begin(), neighbours.end());
    }
    for (const auto& term : every_term(evaluator)) {
      SCOPED_TRACE(term->name());
      const Eigen::VectorXd energies = energies_of(*term, before);
      numerics::EnergySum sum;
      sum.clear(before.dimension(), 0);
      term->add(before, 0, sum);
      EXPECT_NEAR(energies.sum(), sum.value, 1e-12 * sum.value);
      EXPECT_GT(sum.value, 0);
      const Eigen::VectorXd changes = energies_of(*term, after) - energies;
      EXPECT_GT(changes.lpNorm<Eigen::Infinity>(), 1e-9);
      for (std::int32_t cell = 0; cell < 40; ++cell)
        EXPECT_TRUE(near.contains(cell) || std::abs(changes[cell]) <= 1e-9 * sum.value) << "cell " << cell;
    }
  }
}

TEST(SiteMoves, OrSearchesWithHeldSitesLowerTheEnergyWhereNoStepForAllSitesDoes) {
  const GeodesicSolver solver(testing::share(testing::torus(24, 12)));
  OptimizationOptions options;
  options.weights.planarity = 1;
  options.max_iterations = 160;
  const Optimization answer = optimize(solver, random_sites(solver.mesh(), 20, 1), options);
  EXPECT_EQ(answer.stopped, OptimizationTermination::iteration_limit);
  EXPECT_GT(answer.site_moves.held_searches, 0);
  EXPECT_LT(answer.energy, 0.5 * answer.site_moves.energy_before);
  EXPECT_EQ(answer.history.size(), static_cast<std::size_t>(answer.iterations) + 1);
  for (std::size_t i = 1; i < answer.history.size(); ++i)
    EXPECT_LE(answer.history[i].energy, answer.history[i - 1].energy * (1 + 1e-12));
}

TEST(SiteMoves, OfHeldSitesAreNotTriedAndThoseTakenLowerTheEnergyTogether) {
  const TriangleMesh mesh = testing::icosphere(2);
  const GeodesicSolver solver(testing::share(mesh));
  const auto evaluator = std::make_shared<const DiagramEvaluator>(solver, quantities_of_values);
  const auto terms = every_term(evaluator);
  const auto energy_of = [&](SitesState& state) {
    evaluator->evaluate(state, 0, {});
    double energy = 0;
    for (const auto& term : terms) energy += energies_of(*term, state).sum();
    return energy;
  };
  SitesState state(solver.mesh(), random_sites(mesh, 60, 1));
  const double before = energy_of(state);
  std::vector<bool> fixed(120, false);
  for (std::size_t k = 0; k < 60; ++k) fixed[k] = true;
  const auto start = state.sites().points();
  SiteMoves moves(evaluator, terms, fixed, 0.5);
  const SiteMovesPass pass = moves.pass(state, {});
  EXPECT_GT(pass.taken, 10);
  EXPECT_GE(pass.tried, 30 * 8);
  EXPECT_NEAR(energy_of(state), (1 - pass.gain) * before, 1e-9 * before);
  EXPECT_GT(pass.gain, 0.02);
  for (std::size_t i = 0; i < 30; ++i)
    EXPECT_TRUE(state.sites().points()[i].barycentric == start[i].barycentric) << "site " << i;
  const Execution stopped;
  stopped.cancellation.request(StopReason::cancelled);
  testing::expect_cancelled(StopReason::cancelled, [&] { moves.pass(state, stopped); });
}

TEST(SiteMoves, AreNotTriedWhereStepsSuffice) {
  const GeodesicSolver solver(testing::share(testing::icosphere(2)));
  OptimizationOptions options;
  options.weights.equal_area = 1;
  const Optimization answer = optimize(solver, random_sites(solver.mesh(), 30, 1), options);
  EXPECT_EQ(answer.stopped, OptimizationTermination::converged);
  EXPECT_EQ(answer.site_moves.passes, 0);
}

}  // namespace
}  // namespace supple::voronoi
