#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "element_energies.h"
#include "euclidean_springs.h"
#include "network_search.h"
#include "supple/numerics/derivative_check.h"
#include "supple/numerics/system.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::embedded {
namespace {

using surface::GeodesicSolver;
using surface::SurfacePoint;
using surface::TriangleMesh;

/// Random points, each with springs to the next two.
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
    const std::shared_ptr<NetworkEnergy> springs = network_term(solver, network, none_held(network)).energy;
    const auto check = numerics::check_derivatives(*springs, NetworkState(mesh, network.points), small_steps(1e-4));
    EXPECT_LT(check.gradient.error, 1e-7) << check.summary();
    EXPECT_LT(check.hessian.error, 1e-6) << check.summary();
  }
}

TEST(GeodesicSprings, HaveTheDerivativesOfAMollifiedEnergyToo) {
  const TriangleMesh mesh = testing::saddle(6);
  const GeodesicSolver solver(testing::share(mesh));
  const Network network = random_chain(mesh, 4, 0.2, 2);
  const std::shared_ptr<NetworkEnergy> springs =
      network_term(solver, network, none_held(network), {.paths = {.mollifier_length = 0.1}}).energy;
  NetworkState state(mesh, network.points);
  const auto check = numerics::check_derivatives(*springs, state, small_steps(1e-5));
  EXPECT_LT(check.gradient.error, 1e-6) << check.summary();
  EXPECT_LT(check.hessian.error, 1e-4) << check.summary();

  // The mollified energy is close to the exact one.
  const auto energy = [&](double mollifier_length) {
    numerics::System<NetworkState> system(
        state,
        {network_term(solver, network, none_held(network), {.paths = {.mollifier_length = mollifier_length}}).energy},
        numerics::Unknowns(state.dimension()));
    return system.evaluate(0).value;
  };
  EXPECT_NEAR(energy(0.1), energy(0), 0.05 * energy(0));
  EXPECT_NEAR(energy(1e-4), energy(0), 1e-3 * energy(0));
}

TEST(GeodesicSprings, ASquaredDistanceIsATermThatExistsAtZeroLength) {
  const TriangleMesh mesh = testing::icosphere(1);
  const GeodesicSolver solver(testing::share(mesh));
  Network network;
  // Two points at the same place in a face, and two at the same place on an edge, given in either of its faces.
  network.points.assign(2, {FaceId{7}, {0.2, 0.3, 0.5}});
  const std::int32_t across = mesh.twin(0);
  network.points.push_back({FaceId{0}, {0.25, 0.75, 0}});
  SurfacePoint same{FaceId{TriangleMesh::face_of(across)}, Eigen::Vector3d::Zero()};
  same.barycentric[across % 3] = 0.75;
  same.barycentric[(across + 1) % 3] = 0.25;
  network.points.push_back(same);
  network.springs = {{0, 1, 0, 1.5}, {2, 3, 0, 0.5}};
  const std::shared_ptr<NetworkEnergy> springs = network_term(solver, network, none_held(network)).energy;
  const auto check = numerics::check_derivatives(*springs, NetworkState(mesh, network.points), small_steps(1e-3));
  EXPECT_LT(check.gradient.error, 1e-9) << check.summary();
  EXPECT_LT(check.hessian.error, 1e-7) << check.summary();
}

TEST(GeodesicSprings, PartTwoPointsInOnePlaceThatWantToBeApart) {
  const Spring spring{0, 1, 0.5, 2};
  const SpringElement element = spring_element_at_zero(spring, 0.3, 4);
  EXPECT_DOUBLE_EQ(element.value, 0.5);
  // The derivative of weight (g - rest_length)^2 at g = 0 in the direction in which the ends separate.
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

/// A point at a vertex, with springs to points on one side of it.
struct AtVertex {
  explicit AtVertex(TriangleMesh built) : mesh(std::move(built)), solver(testing::share(mesh)) {
    const SurfacePoint tip = surface::vertex_point(mesh, VertexId{0});
    network.points = {tip, {tip.face, {0.3, 0.3, 0.4}}};
    for (int corner = 0; corner < 3; ++corner) {
      const std::int32_t twin = mesh.twin(3 * index(tip.face) + corner);
      if (twin >= 0) network.points.push_back({FaceId{TriangleMesh::face_of(twin)}, {0.2, 0.3, 0.5}});
    }
    const double weights[] = {1.5, 0.5, 2, 0.7};
    for (std::int32_t i = 1; i < static_cast<std::int32_t>(network.points.size()); ++i)
      network.springs.push_back({0, i, 0.05 * i, weights[i - 1]});
  }

  double stiffness() const {
    double sum = 0;
    for (const Spring& spring : network.springs) sum += 2 * spring.weight;
    return sum;
  }

  numerics::System<NetworkState> system(std::shared_ptr<numerics::Term<NetworkState>> term) const {
    const NetworkState state(mesh, network.points);
    return {state, {std::move(term)}, numerics::Unknowns(state.dimension()), {.min_order = 2}};
  }

  TriangleMesh mesh;
  GeodesicSolver solver;
  Network network;
};

/// At a vertex the energy has only directional derivatives. Its gradient there is to be that of steepest descent, and
/// its Hessian that of the flat sectors.
void expect_steepest_way_down(const AtVertex& scene, const std::shared_ptr<numerics::Term<NetworkState>>& term) {
  auto system = scene.system(term);
  system.evaluate(2);
  const double energy = system.energy();
  const Eigen::Vector2d gradient = system.full_gradient().head<2>();
  const double hessian[] = {system.core().coeff(0, 0), system.core().coeff(1, 1)};
  EXPECT_EQ(hessian[0], scene.stiffness());
  EXPECT_EQ(hessian[1], scene.stiffness());

  constexpr double step = 1e-7;
  const auto slope = [&](const Eigen::Vector2d& direction) {
    NetworkState moved(scene.mesh, scene.network.points);
    Eigen::VectorXd way = Eigen::VectorXd::Zero(moved.dimension());
    way.head<2>() = step * direction;
    moved.move(way);
    system.set_state(std::move(moved));
    system.evaluate(0);
    return (system.energy() - energy) / step;
  };
  double least = 0;
  for (int k = 0; k < 360; ++k) {
    const double angle = k * std::numbers::pi / 180;
    least = std::min(least, slope({std::cos(angle), std::sin(angle)}));
  }
  ASSERT_LT(least, -0.1);
  EXPECT_NEAR(gradient.norm(), -least, 1e-3 * -least);
  EXPECT_NEAR(slope(-gradient.normalized()), least, 1e-3 * -least);
}

TEST(GeodesicSprings, PullAPointOffAVertexTheSteepestWay) {
  for (const double angle : {5.0, 7.5}) {
    const AtVertex scene(testing::cone(8, angle));
    ASSERT_TRUE(NetworkState(scene.mesh, scene.network.points).on_tip(0));
    expect_steepest_way_down(scene, network_term(scene.solver, scene.network, none_held(scene.network)).energy);
  }
}

TEST(GeodesicSprings, CountTheStiffnessOfASpringWithoutLengthAtAVertexOnce) {
  AtVertex scene(testing::cone(8, 7.5));
  const auto second = static_cast<std::int32_t>(scene.network.points.size());
  scene.network.points.push_back(scene.network.points.front());
  scene.network.springs.push_back({0, second, 0, 0.9});
  auto system = scene.system(network_term(scene.solver, scene.network, none_held(scene.network)).energy);
  system.evaluate(2);
  for (int k = 0; k < 2; ++k) EXPECT_DOUBLE_EQ(system.core().coeff(k, k), scene.stiffness());
}

TEST(EuclideanSprings, PullAPointOffAVertexTheSteepestWay) {
  for (const double angle : {4.0, 5.5}) {
    const AtVertex scene(testing::cone(8, angle));
    expect_steepest_way_down(scene, std::make_shared<EuclideanSprings>(scene.network));
  }
}

TEST(GeodesicSprings, BillHowEachPathWasFound) {
  const TriangleMesh mesh = testing::torus(16, 8);
  const GeodesicSolver solver(testing::share(mesh));
  const Network network = random_chain(mesh, 6, 0, 1);
  CostLedger cost;
  numerics::System<NetworkState> system(NetworkState(mesh, network.points),
                                        {network_term(solver, network, none_held(network)).energy},
                                        numerics::Unknowns(12), {.execution = {.cost = &cost}});
  system.evaluate(0);
  double found = 0;
  int kinds = 0;
  for (const auto& quantity : cost.quantities()) {
    if (quantity.name != "same_face" && quantity.name != "unfolded" && quantity.name != "searched") continue;
    found += quantity.value;
    ++kinds;
  }
  EXPECT_EQ(kinds, 3);
  EXPECT_EQ(found, static_cast<double>(network.springs.size()));
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
    // A straightest path transports its own direction: the opposite step at its end returns to the start.
    state.move(-tangent);
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_LT((surface::position(mesh, state.points()[i]) - surface::position(mesh, before[i])).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace supple::embedded
