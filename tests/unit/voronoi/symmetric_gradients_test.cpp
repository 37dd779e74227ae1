// Derivatives of objectives where borders run along edges, through vertices and along diagonals of the mesh.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "objectives.h"
#include "supple/numerics/system.h"
#include "support/shapes.h"
#include "support/symmetric_shapes.h"

namespace supple::voronoi {
namespace {

/// Compares the derivative of a term along a random direction by its gradient with central differences.
template <typename Term>
void expect_symmetric_gradient(const testing::SymmetricSites& drawn, RandomStream& stream, bool differentiable) {
  constexpr RequiredQuantities all_quantities{true, true, true, true};
  const surface::GeodesicSolver solver(testing::share(drawn.mesh));
  const auto evaluator = std::make_shared<const DiagramEvaluator>(solver, all_quantities);
  const Term term(evaluator, 1, 0.5 * drawn.mesh.diagonal());
  SitesState state(solver.mesh(), drawn.sites);
  evaluator->evaluate(state, 1, {});
  numerics::EnergySum sum;
  sum.clear(state.dimension(), 1);
  term.add(state, 1, sum);
  EXPECT_TRUE(sum.gradient.allFinite() && std::isfinite(sum.value)) << term.name();
  if (!differentiable) return;
  Eigen::VectorXd direction(state.dimension());
  for (double& x : direction) x = stream.normal();
  direction.normalize();
  const auto value = [&](double along) {
    SitesState moved = state;
    moved.move(along * direction);
    evaluator->evaluate(moved, 0, {});
    numerics::EnergySum other;
    other.clear(moved.dimension(), 0);
    term.add(moved, 0, other);
    return other.value;
  };
  const double step = 1e-5 * drawn.mesh.diagonal();
  const double numeric = (value(step) - value(-step)) / (2 * step);
  EXPECT_NEAR(sum.gradient.dot(direction), numeric, 1e-4 * std::max(1.0, std::abs(numeric))) << term.name();
}

TEST(SymmetricShapes, HaveFiniteGradientsThatAgreeWithDifferences) {
  int compared = 0;
  for (int family = 0; family < testing::symmetric_families; ++family) {
    // If a saddle vertex lies on a border, as on tori and round holes, a region may change its site in a step.
    const bool has_saddles = family == 0 || family == 5 || family == 6;
    for (std::uint64_t seed = 0; seed < 25; ++seed) {
      RandomStream stream("symmetric_gradients", 1000 * static_cast<std::uint64_t>(family) + seed);
      const testing::SymmetricSites drawn = testing::random_symmetric_sites(family, stream);
      SCOPED_TRACE("family " + std::to_string(family) + ", seed " + std::to_string(seed) + ", " + drawn.name);
      // A site on a tip of the mesh has directional derivatives but no gradient. A site on the mesh's boundary cannot
      // leave it.
      const bool one_sided =
          std::any_of(drawn.sites.begin(), drawn.sites.end(), [&](const surface::SurfacePoint& site) {
            return corner_of(site) >= 0 ||
                   (side_of(site) >= 0 && drawn.mesh.twin(3 * index(site.face) + side_of(site)) < 0);
          });
      const bool differentiable = !has_saddles && !one_sided;
      if (differentiable) ++compared;
      expect_symmetric_gradient<EqualAreaTerm>(drawn, stream, differentiable);
      expect_symmetric_gradient<CentroidalTerm>(drawn, stream, differentiable);
      expect_symmetric_gradient<RegularityTerm>(drawn, stream, false);
      expect_symmetric_gradient<PlanarityTerm>(drawn, stream, false);
    }
  }
  EXPECT_GT(compared, 50);
}

}  // namespace
}  // namespace supple::voronoi
