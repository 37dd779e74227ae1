#include <gtest/gtest.h>

#include <cmath>

#include "euclidean_springs.h"
#include "geodesic_springs.h"
#include "spring_energy.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::embedded {
namespace {

using surface::GeodesicSolver;
using surface::SurfacePoint;
using surface::TriangleMesh;

/// Random points with springs from each to the next and to the one after that.
Network random_chain(const TriangleMesh& mesh, int count, double rest_length, std::uint64_t seed) {
  const testing::SurfaceSampler sampler(mesh);
  RandomStream random("random_chain", seed);
  Network network;
  for (int i = 0; i < count; ++i) network.points.push_back(sampler.point(random));
  for (int i = 0; i + 1 < count; ++i) network.springs.push_back({i, i + 1, rest_length, random.uniform(0.5, 2)});
  for (int i = 0; i + 2 < count; ++i) network.springs.push_back({i, i + 2, rest_length, random.uniform(0.5, 2)});
  return network;
}

std::vector<bool> none_held(const Network& network) { return std::vector<bool>(network.points.size(), false); }

numerics::DerivativeCheckOptions small_steps(double step) {
  numerics::DerivativeCheckOptions options;
  options.step = step;
  return options;
}

TEST(GeodesicSprings, HaveTheDerivativesOfTheirEnergy) {
  for (const double rest_length : {0.0, 0.3, 3.0}) {
    const TriangleMesh mesh = testing::torus(16, 8);
    const GeodesicSolver solver(testing::share(mesh));
    const Network network = random_chain(mesh, 6, rest_length, 1);
    GeodesicSprings springs(solver, network, none_held(network), {});
    const auto check = numerics::check_derivatives(springs, NetworkState(mesh, network.points), small_steps(1e-4));
    EXPECT_LT(check.gradient.error, 1e-7) << check.summary();
    EXPECT_LT(check.hessian.error, 1e-6) << check.summary();
  }
}

TEST(GeodesicSprings, HaveTheDerivativesOfAMollifiedEnergyToo) {
  const TriangleMesh mesh = testing::saddle(6);
  const GeodesicSolver solver(testing::share(mesh));
  const Network network = random_chain(mesh, 4, 0.2, 2);
  GeodesicSprings springs(solver, network, none_held(network), {.kept_strips = true, .mollifier_length = 0.1});
  NetworkState state(mesh, network.points);
  const auto check = numerics::check_derivatives(springs, state, small_steps(1e-5));
  EXPECT_LT(check.gradient.error, 1e-6) << check.summary();
  EXPECT_LT(check.hessian.error, 1e-4) << check.summary();
}

TEST(GeodesicSprings, ASquaredDistanceIsATermThatExistsAtZeroLength) {
  const TriangleMesh mesh = testing::icosphere(1);
  const GeodesicSolver solver(testing::share(mesh));
  Network network;
  // Two points in one place of a face, and two in one place of an edge, written in its two faces.
  network.points.assign(2, {FaceId{7}, {0.2, 0.3, 0.5}});
  const std::int32_t across = mesh.twin(0);
  network.points.push_back({FaceId{0}, {0.25, 0.75, 0}});
  SurfacePoint same{FaceId{TriangleMesh::face_of(across)}, Eigen::Vector3d::Zero()};
  same.barycentric[across % 3] = 0.75;
  same.barycentric[(across + 1) % 3] = 0.25;
  network.points.push_back(same);
  network.springs = {{0, 1, 0, 1.5}, {2, 3, 0, 0.5}};
  GeodesicSprings springs(solver, network, none_held(network), {});
  const auto check = numerics::check_derivatives(springs, NetworkState(mesh, network.points), small_steps(1e-3));
  EXPECT_LT(check.gradient.error, 1e-9) << check.summary();
  EXPECT_LT(check.hessian.error, 1e-7) << check.summary();
}

TEST(GeodesicSprings, PartTwoPointsInOnePlaceThatWantToBeApart) {
  const Spring spring{0, 1, 0.5, 2};
  const SpringElement element = spring_element_at_zero(spring, 0.3, 4);
  EXPECT_DOUBLE_EQ(element.value, 0.5);
  // The slope of weight (g - rest_length)^2 at g = 0 along the way that the ends part on.
  EXPECT_NEAR(element.gradient.head<2>().norm(), 2 * 2 * 0.5, 1e-14);
  EXPECT_NEAR(element.gradient.tail<2>().norm(), 2 * 2 * 0.5, 1e-14);
  EXPECT_NE(spring_element_at_zero(spring, 0.3, 5).gradient, element.gradient)
      << "springs part in different directions";
}

TEST(EuclideanSprings, HaveTheDerivativesOfTheirEnergyWithinFaces) {
  const TriangleMesh mesh = testing::torus(16, 8);
  for (const double rest_length : {0.0, 0.4}) {
    const Network network = random_chain(mesh, 6, rest_length, 3);
    EuclideanSprings springs(network);
    const auto check = numerics::check_derivatives(springs, NetworkState(mesh, network.points), small_steps(1e-4));
    EXPECT_LT(check.gradient.error, 1e-8) << check.summary();
    EXPECT_LT(check.hessian.error, 1e-7) << check.summary();
  }
}

TEST(NetworkState, MovesEachPointByItselfAndStopsEachAtItsBoundary) {
  const TriangleMesh mesh = testing::flat_grid(4, 4);
  NetworkState state(mesh, {{FaceId{0}, {0.3, 0.3, 0.4}}, {FaceId{20}, {0.3, 0.3, 0.4}}});
  const auto frame = surface::tangent_frame(mesh, FaceId{0});
  Eigen::VectorXd step(4);
  step << frame.transpose() * Eigen::Vector3d(-10, 0, 0), 0.1, 0.05;
  const Eigen::VectorXd travelled = state.move(step);
  EXPECT_LT(travelled.head<2>().norm(), 1.0);
  EXPECT_GT(travelled.head<2>().norm(), 0.0);
  EXPECT_EQ(travelled.tail<2>(), step.tail<2>()) << "the other point walks all of its way";
  EXPECT_NEAR(surface::position(mesh, state.points()[0]).x(), 0, 1e-13);
}

TEST(NetworkState, CarriesTangentsAlongTheWayOfEachPoint) {
  const TriangleMesh mesh = testing::torus(16, 8);
  const testing::SurfaceSampler sampler(mesh);
  RandomStream random("transport", 1);
  for (int trial = 0; trial < 20; ++trial) {
    NetworkState state(mesh, {sampler.point(random), sampler.point(random)});
    Eigen::VectorXd step(4);
    for (int i = 0; i < 4; ++i) step[i] = random.uniform(-0.5, 0.5);
    Eigen::VectorXd tangent = step;
    const auto before = state.points();
    state.move(step);
    ASSERT_TRUE(state.transport(tangent));
    // The direction of a straightest path, carried along it, is its direction at the end: going on, then back, returns.
    state.move(-tangent);
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_LT((surface::position(mesh, state.points()[i]) - surface::position(mesh, before[i])).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace supple::embedded
