#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <limits>

#include "element_energies.h"
#include "network_search.h"
#include "supple/base/cost_ledger.h"
#include "supple/embedded/network_builders.h"
#include "supple/embedded/relaxation.h"
#include "support/expect_error.h"
#include "support/nearest_point.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::embedded {
namespace {

using surface::GeodesicSolver;
using surface::SurfacePoint;
using surface::TriangleMesh;
using testing::expect_error;

/// The corners of a triangle in the plane, as columns.
using Corners = Eigen::Matrix<double, 2, 3>;
std::array<double, 3> sides_of(const Corners& corners) {
  std::array<double, 3> lengths;
  for (int k = 0; k < 3; ++k) lengths[static_cast<std::size_t>(k)] = (corners.col((k + 1) % 3) - corners.col(k)).norm();
  return lengths;
}
Eigen::Vector3d vector_of(const std::array<double, 3>& lengths) { return {lengths[0], lengths[1], lengths[2]}; }

/// Energy density of a deformation gradient [Thesis, eq. 3.20].
double density(const Eigen::Matrix2d& f, const MembraneMaterial& material) {
  const double mu = material.youngs_modulus / (2 * (1 + material.poisson_ratio));
  const double lambda = material.youngs_modulus * material.poisson_ratio /
                        ((1 + material.poisson_ratio) * (1 - 2 * material.poisson_ratio));
  const double log_j = std::log(f.determinant());
  return mu / 2 * ((f.transpose() * f).trace() - 2 - 2 * log_j) + lambda / 2 * log_j * log_j;
}

TEST(TriangleEnergy, IsThatOfTheLinearMapThatGivesTheSidesTheirLengths) {
  RandomStream random("triangle_energy", 1);
  const MembraneMaterial material{3, 0.4, 0.2};
  for (int trial = 0; trial < 50; ++trial) {
    const Corners rest = Corners::NullaryExpr([&] { return random.uniform(-1, 1); });
    Eigen::Matrix2d edges;
    edges << rest.col(1) - rest.col(0), rest.col(2) - rest.col(0);
    const double area = edges.determinant() / 2;
    if (std::abs(area) < 0.02) continue;
    Eigen::Matrix2d f =
        Eigen::Matrix2d::Identity() + 0.5 * Eigen::Matrix2d::NullaryExpr([&] { return random.uniform(-1, 1); });
    if (f.determinant() < 0.05) continue;
    const TriangleEnergy energy(sides_of(rest), material);
    const Eigen::Vector3d lengths = vector_of(sides_of(f * rest));
    const double expected = material.thickness * std::abs(area) * density(f, material);
    EXPECT_NEAR(energy.at(lengths).energy, expected, 1e-12 * (1 + expected) / std::abs(area));
    const Eigen::Vector2d singular = f.jacobiSvd().singularValues();
    EXPECT_LT((energy.stretches(lengths) - singular).norm(), 1e-10 / std::abs(area));
  }
}

TEST(TriangleEnergy, HasItsDerivativesByTheLengths) {
  const TriangleEnergy energy({1, 1.3, 0.8}, {2, 0.3, 0.5});
  for (const Eigen::Vector3d& at :
       {Eigen::Vector3d(1.2, 1.1, 0.9), Eigen::Vector3d(0.5, 0.6, 1.05), Eigen::Vector3d(3, 4, 2)}) {
    const auto value = energy.at(at);
    const double h = 1e-5;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(k);
      const auto ahead = energy.at(at + step);
      const auto behind = energy.at(at - step);
      EXPECT_NEAR(value.first[k], (ahead.energy - behind.energy) / (2 * h), 1e-7 * (1 + value.first.norm()));
      EXPECT_LT((value.second.col(k) - (ahead.first - behind.first) / (2 * h)).norm(),
                1e-6 * (1 + value.second.norm()));
    }
  }
}

TEST(TriangleEnergy, IsLeastAtRestAndInfiniteWhereThereIsNoTriangle) {
  const TriangleEnergy energy({1, 1.3, 0.8}, {});
  const auto rest = energy.at({1, 1.3, 0.8});
  EXPECT_NEAR(rest.energy, 0, 1e-15);
  EXPECT_LT(rest.first.norm(), 1e-14);
  EXPECT_GT(rest.second.eigenvalues().real().minCoeff(), 0);
  EXPECT_LT((energy.stretches({1, 1.3, 0.8}) - Eigen::Vector2d(1, 1)).norm(), 1e-7);
  for (const Eigen::Vector3d& none : {Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(1, 1, 3), Eigen::Vector3d(0, 1, 1)}) {
    EXPECT_EQ(energy.at(none).energy, std::numeric_limits<double>::infinity());
    EXPECT_EQ(energy.stretches(none), Eigen::Vector2d(0, 0));
  }
}

/// A membrane with the triangles of the points' triangulation.
Network membrane_of(const GeodesicSolver& solver, const std::vector<SurfacePoint>& points, double scale) {
  Network network;
  network.points = points;
  network.triangles = membrane_at_rest(solver, points, triangulate(solver, points).triangles, scale);
  return network;
}

TEST(Membranes, HaveTheDerivativesOfTheirEnergy) {
  for (const TriangleMesh& mesh : {testing::torus(16, 8), testing::icosphere(2), testing::genus3(3)}) {
    const GeodesicSolver solver(testing::share(mesh));
    Network network = membrane_of(solver, poisson_disk_points(solver, 0.2 * mesh.diagonal(), 3), 1);
    RandomStream random("membrane", 3);
    for (auto& triangle : network.triangles)
      for (double& length : triangle.rest_lengths) length *= random.uniform(0.9, 1.1);
    ASSERT_GE(network.triangles.size(), 10U);
    // A spring along a triangle's side, in the opposite direction: one path serves both.
    const auto& corners = network.triangles.front().corners;
    network.springs = {{corners[1], corners[0], 0.2, 0.7}, {network.triangles.back().corners[0], corners[2], 0.1, 1}};
    const std::shared_ptr<NetworkEnergy> elements =
        network_term(solver, network, std::vector<bool>(network.points.size(), false)).energy;
    numerics::DerivativeCheckOptions options;
    options.step = 1e-4 * mesh.diagonal();
    const auto check = numerics::check_derivatives(*elements, NetworkState(mesh, network.points), options);
    EXPECT_LT(check.gradient.error, 1e-7) << check.summary();
    EXPECT_LT(check.hessian.error, 1e-5) << check.summary();
  }
}

TEST(Membranes, FollowAUniformStretchOfTheirBorderInThePlane) {
  RandomStream random("patch", 1);
  const TriangleMesh mesh = testing::jittered_grid(12, 12, random);
  const GeodesicSolver solver(testing::share(mesh));
  const Eigen::Vector3d low = mesh.positions().front().cwiseMin(mesh.positions().back());
  const Eigen::Vector3d size = (mesh.positions().back() - mesh.positions().front()).cwiseAbs();
  const auto at = [&](double x, double y) {
    return testing::nearest_point(mesh, Eigen::Vector3d(low[0] + x * size[0], low[1] + y * size[1], low[2]));
  };
  // A sheet of 5 x 5 points, whose border moves by a linear map.
  const int n = 5;
  std::vector<Eigen::Vector2d> rest;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const bool border = i == 0 || j == 0 || i == n - 1 || j == n - 1;
      const double shift = border ? 0 : 0.02;
      rest.emplace_back(0.4 + 0.05 * i + shift * random.uniform(-1, 1), 0.4 + 0.05 * j + shift * random.uniform(-1, 1));
    }
  std::vector<std::array<std::int32_t, 3>> corners;
  for (int j = 0; j + 1 < n; ++j)
    for (int i = 0; i + 1 < n; ++i) {
      const int a = n * j + i;
      corners.push_back({a, a + 1, a + n + 1});
      corners.push_back({a, a + n + 1, a + n});
    }
  Network network;
  for (const auto& p : rest) network.points.push_back(at(p[0], p[1]));
  network.triangles = membrane_at_rest(solver, network.points, corners);
  Eigen::Matrix2d map;
  map << 1.6, 0.3, -0.1, 0.8;
  const Eigen::Vector2d middle(0.5, 0.5);
  std::vector<Eigen::Vector2d> moved;
  for (const auto& p : rest) moved.push_back(middle + map * (p - middle));
  for (int k = 0; k < n * n; ++k) {
    const int i = k % n;
    const int j = k / n;
    const auto& to = moved[static_cast<std::size_t>(k)];
    network.points[static_cast<std::size_t>(k)] = at(to[0], to[1]);
    if (i == 0 || j == 0 || i == n - 1 || j == n - 1) network.fixed_points.push_back(k);
    // Inner points start elsewhere.
    else
      network.points[static_cast<std::size_t>(k)] =
          at(to[0] + 0.01 * random.uniform(-1, 1), to[1] + 0.01 * random.uniform(-1, 1));
  }
  CostLedger bill;
  const Relaxation relaxed = relax(solver, network, {.tolerance = 1e-12}, {.cost = &bill});
  EXPECT_EQ(relaxed.stopped, RelaxationTermination::converged);
  EXPECT_LE(relaxed.iterations, 12);
  for (std::size_t k = 0; k < moved.size(); ++k) {
    const Eigen::Vector3d p = surface::position(mesh, relaxed.points[k]);
    const Eigen::Vector3d expected = surface::position(mesh, at(moved[k][0], moved[k][1]));
    EXPECT_LT((p - expected).norm(), 1e-9 * size.norm()) << k;
  }
  const Eigen::Matrix2d scaled =
      Eigen::Vector2d(size[0], size[1]).asDiagonal() * map * Eigen::Vector2d(1 / size[0], 1 / size[1]).asDiagonal();
  const Eigen::Vector2d singular = scaled.jacobiSvd().singularValues();
  ASSERT_EQ(relaxed.triangles.size(), corners.size());
  double energy = 0;
  for (const TriangleState& triangle : relaxed.triangles) {
    EXPECT_NEAR(triangle.stretches[0], singular[0], 1e-8);
    EXPECT_NEAR(triangle.stretches[1], singular[1], 1e-8);
    energy += triangle.energy;
  }
  EXPECT_NEAR(energy, relaxed.energy, 1e-12 * energy);
  bool billed = false;
  for (const auto& effect : bill.effects()) billed = billed || (effect.name == "membrane" && effect.ran);
  EXPECT_TRUE(billed);
  EXPECT_TRUE(relaxed.loose_points.empty());
}

TEST(Membranes, ConvergeQuadraticallyOnATorus) {
  const TriangleMesh mesh = testing::torus(48, 24);
  const GeodesicSolver solver(testing::share(mesh));
  const auto points = poisson_disk_points(solver, 0.2, 4);
  Network network = membrane_of(solver, points, 0.9);
  network.fixed_points = {0};
  const Relaxation relaxed = relax(solver, network, {.tolerance = 1e-11});
  ASSERT_EQ(relaxed.stopped, RelaxationTermination::converged);
  EXPECT_LE(relaxed.iterations, 25);
  const auto& history = relaxed.history;
  const double before = history[history.size() - 2].gradient_norm;
  EXPECT_LT(history.back().gradient_norm, 1e-2 * before) << "the last step is quadratic";
  for (std::size_t i = 1; i < history.size(); ++i) EXPECT_LE(history[i].energy, history[i - 1].energy * (1 + 1e-12));
}

TEST(Membranes, ComeToRestWithPointsAtVertices) {
  // At the middle vertex of a saddle paths bend, and a point can be in equilibrium there.
  const TriangleMesh mesh = testing::saddle(5);
  const GeodesicSolver solver(testing::share(mesh));
  const testing::SurfaceSampler sampler(mesh);
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    RandomStream random("tips", seed);
    Network network;
    network.points = {surface::vertex_point(mesh, VertexId{0})};
    for (int i = 0; i < 3; ++i) network.points.push_back(sampler.point(random));
    network.triangles = membrane_at_rest(solver, network.points, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}}, 0.8);
    network.fixed_points = {1, 2, 3};
    bool flat = false;
    for (const auto& triangle : network.triangles) {
      const auto& [a, b, c] = triangle.rest_lengths;
      flat = flat || 2 * std::max({a, b, c}) > 0.95 * (a + b + c);
    }
    if (flat) continue;
    const Relaxation relaxed = relax(solver, network, {.tolerance = 1e-10});
    EXPECT_EQ(relaxed.stopped, RelaxationTermination::converged) << seed;
    // No direction lowers the energy.
    const std::shared_ptr<NetworkEnergy> elements = network_term(solver, network, {false, true, true, true}).energy;
    const auto energy_at = [&](const SurfacePoint& at) {
      auto points = relaxed.points;
      points[0] = at;
      numerics::System<NetworkState> system(
          NetworkState(mesh, points),
          {network_term(solver, network, std::vector<bool>{false, true, true, true}).energy}, numerics::Unknowns(8));
      return system.evaluate(0).value;
    };
    const double here = energy_at(relaxed.points[0]);
    for (int k = 0; k < 32; ++k) {
      const double angle = 2 * std::numbers::pi * k / 32;
      const auto moved =
          surface::retract(mesh, relaxed.points[0], 1e-4 * Eigen::Vector2d(std::cos(angle), std::sin(angle)), {});
      EXPECT_GE(energy_at(moved.end), here - 1e-12) << seed << " direction " << k;
    }
  }
}

TEST(Membranes, WithoutAreaAtTheStartAreRefusedByName) {
  const TriangleMesh mesh = testing::torus(12, 6);
  const GeodesicSolver solver(testing::share(mesh));
  Network network;
  network.points.assign(4, SurfacePoint{FaceId{3}, {0.2, 0.3, 0.5}});
  network.points[1].barycentric = {0.6, 0.2, 0.2};
  network.points[2].barycentric = {0.4, 0.25, 0.35};
  network.points[3].barycentric = {0.1, 0.1, 0.8};
  network.triangles = {{{0, 1, 3}, {0.1, 0.1, 0.1}}, {{0, 1, 2}, {0.1, 0.1, 0.1}}};
  const Error error = expect_error("network.collapsed", [&] { relax(solver, network); });
  EXPECT_EQ(testing::places(error), std::vector<std::string>{"triangles/1"});
}

TEST(Membranes, HaveNoStraightSides) {
  const TriangleMesh mesh = testing::torus(12, 6);
  const GeodesicSolver solver(testing::share(mesh));
  Network network = membrane_of(solver, points_in_faces(mesh, {0.3, 0.3, 0.4}), 1);
  expect_error("network.invalid_option", [&] { relax(solver, network, {.spring_length = SpringLength::euclidean}); });
}

TEST(CheckedNetwork, NamesTheTriangleThatIsWrong) {
  const TriangleMesh mesh = testing::two_components();
  const auto refused = [&](const Network& network, const std::string& code) {
    return testing::places(expect_error(code, [&] { checked_network(mesh, network); }));
  };
  Network good;
  good.points = {{FaceId{0}, {0.2, 0.3, 0.5}}, {FaceId{1}, {0.2, 0.3, 0.5}}, {FaceId{2}, {0.2, 0.3, 0.5}}};
  good.triangles = {{{0, 1, 2}, {1, 1, 1}}};
  EXPECT_NO_THROW(checked_network(mesh, good));
  Network network = good;
  network.triangles[0].corners = {0, 1, 3};
  EXPECT_EQ(refused(network, "network.triangle"), std::vector<std::string>{"triangles/0/2"});
  network.triangles[0].corners = {0, 1, 0};
  EXPECT_EQ(refused(network, "network.triangle"), std::vector<std::string>{"triangles/0"});
  for (const std::array<double, 3>& lengths : {std::array{1.0, 2.0, 3.0},
                                               {1.0, 1.0, 3.0},
                                               {0.0, 1.0, 1.0},
                                               {1.0, -1.0, 1.0},
                                               {1.0, 1.0, std::numeric_limits<double>::infinity()}}) {
    network = good;
    network.triangles[0].rest_lengths = lengths;
    EXPECT_EQ(refused(network, "network.triangle"), std::vector<std::string>{"triangles/0"});
  }
  network = good;
  network.points[2].face = FaceId{mesh.face_count() - 1};
  EXPECT_EQ(refused(network, "network.unreachable"), std::vector<std::string>{"triangles/0"});
  network = good;
  network.material = {0, 0.5, -1};
  EXPECT_EQ(refused(network, "network.membrane"),
            (std::vector<std::string>{"membrane/youngs_modulus", "membrane/thickness", "membrane/poisson_ratio"}));
  network.triangles.clear();
  EXPECT_NO_THROW(checked_network(mesh, network)) << "nothing is made of it";
}

TEST(MembraneAtRest, HasTheLengthsOfItsSidesTimesTheScale) {
  const TriangleMesh mesh = testing::torus(16, 8);
  const GeodesicSolver solver(testing::share(mesh));
  const auto points = points_in_faces(mesh, {0.3, 0.3, 0.4});
  const auto triangles = membrane_at_rest(solver, points, {{0, 9, 4}, {4, 9, 30}}, 0.5);
  for (const auto& triangle : triangles)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(triangle.rest_lengths[k],
                  0.5 * solver.distance(points[static_cast<std::size_t>(triangle.corners[k])],
                                        points[static_cast<std::size_t>(triangle.corners[(k + 1) % 3])]),
                  1e-12);
  expect_error("network.triangle", [&] { membrane_at_rest(solver, points, {{0, 1, 100'000}}); });
}

}  // namespace
}  // namespace supple::embedded
