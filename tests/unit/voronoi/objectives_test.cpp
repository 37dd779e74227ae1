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

constexpr Needs everything{true, true, true};

/// The derivative of a term along a random direction by central differences, and by its gradient.
struct Compared {
  double analytic;
  double numeric;
};
template <typename MakeTerm>
Compared compare(const TriangleMesh& mesh, int sites, std::uint64_t seed, const MakeTerm& make, double step) {
  const GeodesicSolver solver(testing::share(mesh));
  const auto finder = std::make_shared<const DiagramFinder>(solver, everything);
  const auto term = make(finder);
  SitesState state(solver.mesh(), random_sites(mesh, sites, seed));
  finder->find(state, 1, {});
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
    finder->find(moved, 0, {});
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

using Finder = std::shared_ptr<const DiagramFinder>;

TEST(DiagramTerms, EdgeLengthHasItsGradient) {
  expect_gradient([](const Finder& finder) { return std::make_shared<EdgeLengthTerm>(finder, 1, 0.5, 0.3); });
}
TEST(DiagramTerms, PlanarityHasItsGradient) {
  expect_gradient([](const Finder& finder) { return std::make_shared<PlanarityTerm>(finder, 1, 0.5); });
}
TEST(DiagramTerms, RegularityHasItsGradient) {
  expect_gradient([](const Finder& finder) { return std::make_shared<RegularityTerm>(finder, 1, 0.5); });
}
// The integral of squared distances is a sum over triangles in which these are not quadratic where paths come from
// several directions: where the surface is flat or fine the gradient is exact to 1e-5, on coarse edges to 1e-3.
TEST(DiagramTerms, CentroidalHasItsGradient) {
  const auto make = [](const Finder& finder) { return std::make_shared<CentroidalTerm>(finder, 1, 0.5); };
  for (const auto& [mesh, sites, tolerance] : {std::tuple(testing::flat_grid(5, 4), 25, 1e-6),
                                               {testing::icosphere(4), 60, 1e-5},
                                               {testing::torus(20, 10), 40, 1e-3}}) {
    const Compared found = compare(mesh, sites, 4, make, 1e-4);
    EXPECT_NEAR(found.analytic, found.numeric, tolerance * std::max(1.0, std::abs(found.numeric)))
        << mesh.face_count() << " faces";
  }
}
TEST(DiagramTerms, EqualAreaHasItsGradient) {
  expect_gradient([](const Finder& finder) { return std::make_shared<EqualAreaTerm>(finder, 1, 0.5); });
}

TEST(Optimization, MakesSitesOfASphereRegular) {
  const GeodesicSolver solver(testing::share(testing::icosphere(3)));
  for (const OptimizationMethod method : {OptimizationMethod::gauss_newton, OptimizationMethod::lbfgs}) {
    for (int objective = 0; objective < 5; ++objective) {
      OptimizationOptions options;
      double* weights[] = {&options.weights.edge_length, &options.weights.planarity, &options.weights.regularity,
                           &options.weights.centroidal, &options.weights.equal_area};
      *weights[objective] = 1;
      options.method = method;
      options.max_iterations = 60;
      const Optimization result = optimize(solver, random_sites(solver.mesh(), 60, 1), options);
      std::printf("method %d objective %d: %s %d iterations, energy %g -> %g gradient %.2e -> %.2e (tol %.1e)\n",
                  static_cast<int>(method), objective, result.stopped.c_str(), result.iterations,
                  result.history.front().energy, result.energy, result.history.front().gradient_norm,
                  result.gradient_norm, result.gradient_tolerance);
      EXPECT_LT(result.energy, result.history.front().energy);
    }
  }
}

}  // namespace
}  // namespace supple::voronoi
