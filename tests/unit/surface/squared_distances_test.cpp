#include "squared_distances.h"

#include <gtest/gtest.h>

#include <memory>

#include "supple/numerics/derivative_check.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

/// Checks at random points, whose paths stay away from vertices over the short steps of the differences.
void expect_derivatives(TriangleMesh built, AnchorSearch search, bool on_edges) {
  const auto mesh = std::make_shared<const TriangleMesh>(std::move(built));
  const GeodesicSolver solver(mesh);
  RandomStream random("karcher_objective_test", 1);
  const Execution execution;
  int checked = 0;
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<SurfacePoint> anchors;
    for (int i = 0; i < 4; ++i) anchors.push_back(testing::random_point(*mesh, random));
    const SurfacePoint p = on_edges ? testing::random_edge_point(*mesh, random) : testing::random_point(*mesh, random);
    AnchorDistances distances(solver, anchors);
    distances.use(search, execution);
    numerics::System<KarcherState> system(
        KarcherState(*mesh, p),
        {std::make_shared<SquaredDistances>(*mesh, distances, std::vector<double>{0.1, 0.2, 0.3, 0.4})},
        numerics::Unknowns(2), {.min_order = 2});
    numerics::DerivativeCheckOptions options;
    options.step = 2e-3 * mesh->mean_edge_length();
    options.levels = 3;
    const numerics::DerivativeCheck check = check_derivatives(system, options);
    // Where a path sweeps over a vertex within the step the Hessian jumps: such states are no test of it.
    if (check.hessian.uncertainty > 1e-6 || check.gradient.uncertainty > 1e-7) continue;
    ++checked;
    EXPECT_LT(check.gradient.error, 1e-6) << check.summary();
    EXPECT_LT(check.hessian.error, 1e-6) << check.summary();
  }
  EXPECT_GE(checked, 12);
}

TEST(SquaredDistances, DerivativesMatchFiniteDifferencesOnASphere) {
  expect_derivatives(testing::icosphere(2), AnchorSearch::pairs, false);
}
TEST(SquaredDistances, DerivativesMatchFiniteDifferencesWherePathsPassSaddleVertices) {
  expect_derivatives(testing::saddle(8), AnchorSearch::pairs, false);
}
TEST(SquaredDistances, DerivativesMatchFiniteDifferencesAtPointsOnEdges) {
  expect_derivatives(testing::torus(16, 8), AnchorSearch::pairs, true);
}
TEST(SquaredDistances, DerivativesMatchFiniteDifferencesWithOneSearchForAllAnchors) {
  expect_derivatives(testing::torus(16, 8), AnchorSearch::one_to_many, false);
}
TEST(SquaredDistances, DerivativesMatchFiniteDifferencesWithKeptFields) {
  expect_derivatives(testing::torus(16, 8), AnchorSearch::fields, false);
}
TEST(SquaredDistances, DerivativesMatchFiniteDifferencesOnGuidedSearches) {
  expect_derivatives(testing::trefoil_knot(60, 8), AnchorSearch::guided, false);
}

}  // namespace
}  // namespace supple::surface
