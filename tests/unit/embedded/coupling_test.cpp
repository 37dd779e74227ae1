#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <memory>

#include "network_search.h"
#include "supple/base/random.h"
#include "supple/embedded/network_builders.h"
#include "supple/numerics/system.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::embedded {
namespace {

using Eigen::Vector3d;
using surface::GeodesicSolver;
using surface::SurfacePoint;
using surface::TriangleMesh;

Eigen::VectorXd nodes_of(const TriangleMesh& mesh) {
  Eigen::VectorXd nodes(3 * mesh.vertex_count());
  for (std::int32_t i = 0; i < mesh.vertex_count(); ++i)
    nodes.segment<3>(3 * static_cast<Eigen::Index>(i)) = mesh.positions()[i];
  return nodes;
}

/// A network on a deformable host, and the one term of its energy.
struct Coupled {
  std::shared_ptr<const GeodesicSolver> solver;
  std::shared_ptr<NetworkEnergy> elements;
  NetworkState state;

  Coupled(const TriangleMesh& mesh, const Network& network)
      : solver(std::make_shared<GeodesicSolver>(testing::share(mesh))),
        elements(network_term(*solver, network, std::vector<bool>(network.points.size(), false)).energy),
        state(solver, network.points, nodes_of(mesh)) {}

  numerics::EnergySum sum(NetworkState& at, int order) const {
    numerics::EnergySum sum;
    sum.clear(at.dimension(), order);
    elements->prepare(at, order, {});
    elements->add(at, order, sum);
    return sum;
  }
};

/// The matrix that turns a point's tangent coordinates on one surface into those on another with the same faces.
Eigen::Matrix2d between(const TriangleMesh& before, const TriangleMesh& after, FaceId face) {
  const auto sides = [&](const TriangleMesh& mesh) -> Eigen::Matrix2d {
    const auto& [a, b, c] = mesh.faces()[index(face)];
    Eigen::Matrix<double, 3, 2> edges;
    edges << mesh.positions()[b] - mesh.positions()[a], mesh.positions()[c] - mesh.positions()[a];
    return surface::tangent_frame(mesh, face).transpose() * edges;
  };
  return sides(after) * sides(before).inverse();
}

/// Compares the energy's derivatives with finite differences, in tangent coordinates of the first state.
numerics::DerivativeCheck check(const Coupled& coupled, double step) {
  const auto function = [&](const Eigen::VectorXd& by, int order) {
    NetworkState state = coupled.state;
    state.move(by);
    numerics::EnergySum sum = coupled.sum(state, order);
    for (std::size_t i = 0; i < state.points().size(); ++i) {
      const FaceId face = coupled.state.points()[i].face;
      EXPECT_EQ(state.points()[i].face, face);
      auto part = sum.gradient.segment<2>(2 * static_cast<Eigen::Index>(i));
      part = (between(coupled.state.mesh(), state.mesh(), face).transpose() * part).eval();
    }
    numerics::Evaluation evaluation{sum.value, sum.gradient, {}};
    if (order >= 2) evaluation.hessian = sum.hessian.matrix(state.dimension());
    return evaluation;
  };
  return numerics::check_derivatives(function, coupled.state.dimension(), {.step = step});
}

std::vector<SurfacePoint> random_points(const TriangleMesh& mesh, int count, RandomStream& random) {
  const testing::SurfaceSampler sampler(mesh);
  std::vector<SurfacePoint> points;
  // Points far enough from edges that a small step stays in the face.
  while (static_cast<int>(points.size()) < count) {
    const SurfacePoint point = sampler.point(random);
    if (point.barycentric.minCoeff() > 0.05) points.push_back(point);
  }
  return points;
}

Network springs_between(std::vector<SurfacePoint> points, RandomStream& random, std::size_t count) {
  Network network;
  network.points = std::move(points);
  const auto n = static_cast<int>(network.points.size());
  for (std::size_t i = 0; i < count; ++i) {
    const int from = random.below(n);
    const int to = (from + 1 + random.below(n - 1)) % n;
    network.springs.push_back({from, to, random.uniform(0, 0.3), random.uniform(0.5, 2)});
  }
  return network;
}

TEST(Coupling, SpringsHaveTheDerivativesOfTheirEnergyByPointsAndNodes) {
  RandomStream random("coupling", 4);
  for (const TriangleMesh& mesh : {testing::icosphere(1), testing::torus(9, 5), testing::saddle(4)}) {
    const Coupled coupled(mesh, springs_between(random_points(mesh, 5, random), random, 6));
    const auto found = check(coupled, 1e-4);
    EXPECT_LT(found.gradient.error, 1e-7) << found.summary();
    EXPECT_LT(found.hessian.error, 1e-5) << found.summary();
  }
}

TEST(Coupling, TrianglesHaveTheDerivativesOfTheirEnergyByPointsAndNodes) {
  const TriangleMesh mesh = testing::icosphere(1);
  const GeodesicSolver solver(testing::share(mesh));
  Network network;
  network.points = poisson_disk_points(solver, 0.3 * mesh.diagonal(), 2);
  network.triangles = membrane_at_rest(solver, network.points, triangulate(solver, network.points).triangles, 0.9);
  ASSERT_GE(network.triangles.size(), 8U);
  network.springs = {{0, 1, 0.1, 1}};
  const auto found = check(Coupled(mesh, network), 1e-4);
  EXPECT_LT(found.gradient.error, 1e-7) << found.summary();
  EXPECT_LT(found.hessian.error, 1e-5) << found.summary();
}

TEST(Coupling, HasThePointsDerivativesOfARigidHost) {
  RandomStream random("coupling_rigid", 1);
  const TriangleMesh mesh = testing::genus3(2);
  const Network network = springs_between(random_points(mesh, 12, random), random, 30);
  Coupled coupled(mesh, network);
  const numerics::EnergySum on_host = coupled.sum(coupled.state, 2);
  NetworkState rigid(mesh, network.points);
  const std::shared_ptr<NetworkEnergy> elements =
      network_term(*coupled.solver, network, std::vector<bool>(12, false)).energy;
  elements->prepare(rigid, 2, {});
  numerics::EnergySum alone;
  alone.clear(rigid.dimension(), 2);
  elements->add(rigid, 2, alone);
  EXPECT_DOUBLE_EQ(on_host.value, alone.value);
  EXPECT_LT((on_host.gradient.head(24) - alone.gradient).norm(), 1e-10 * alone.gradient.norm());
  numerics::EnergySum copy = on_host;
  const Eigen::MatrixXd all = copy.hessian.matrix(coupled.state.dimension());
  const Eigen::MatrixXd own = alone.hessian.matrix(24);
  EXPECT_LT((all.topLeftCorner(24, 24) - own).norm(), 1e-8 * own.norm());
}

TEST(Coupling, ForcesAndMomentsOnTheHostSumToZero) {
  // The host carries the points: forces on them are forces on its nodes.
  RandomStream random("coupling_forces", 1);
  for (const TriangleMesh& mesh : {testing::icosphere(2), testing::trefoil_knot(40, 6)}) {
    Coupled coupled(mesh, springs_between(random_points(mesh, 8, random), random, 20));
    const numerics::EnergySum sum = coupled.sum(coupled.state, 1);
    Vector3d force = Vector3d::Zero();
    Vector3d moment = Vector3d::Zero();
    double all = 0;
    for (std::int32_t i = 0; i < mesh.vertex_count(); ++i) {
      const Vector3d own = sum.gradient.segment<3>(coupled.state.node_row(i));
      force += own;
      moment += coupled.state.node(i).cross(own);
      all += own.norm();
    }
    EXPECT_LT(force.norm(), 1e-12 * all);
    EXPECT_LT(moment.norm(), 1e-11 * all * mesh.diagonal());
  }
}

TEST(Coupling, MovesWithTheHostWithoutAChangeOfEnergy) {
  RandomStream random("coupling_motion", 1);
  const TriangleMesh mesh = testing::genus3(2);
  Coupled coupled(mesh, springs_between(random_points(mesh, 8, random), random, 20));
  const double energy = coupled.sum(coupled.state, 0).value;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  Eigen::VectorXd step = Eigen::VectorXd::Zero(coupled.state.dimension());
  for (std::int32_t i = 0; i < mesh.vertex_count(); ++i)
    step.segment<3>(coupled.state.node_row(i)) =
        turn * coupled.state.node(i) + Vector3d(1, 0, -4) - coupled.state.node(i);
  NetworkState moved = coupled.state;
  moved.move(step);
  EXPECT_NEAR(coupled.sum(moved, 0).value, energy, 1e-12 * energy);
  for (std::size_t i = 0; i < moved.points().size(); ++i)
    EXPECT_EQ(moved.points()[i].face, coupled.state.points()[i].face);
}

TEST(Coupling, PullsOnAVertexWhereAPointRestsOnIt) {
  // A point on a saddle vertex with springs on all sides stays there, and the derivatives by the host's nodes are
  // right.
  const TriangleMesh mesh = testing::saddle(6);
  std::int32_t middle = 0;
  for (std::int32_t i = 0; i < mesh.vertex_count(); ++i)
    if (mesh.positions()[i].norm() < 1e-12) middle = i;
  Network network;
  network.points.push_back(surface::vertex_point(mesh, VertexId{middle}));
  RandomStream random("coupling_tip", 1);
  for (const SurfacePoint& point : random_points(mesh, 5, random)) network.points.push_back(point);
  for (std::int32_t i = 1; i < 6; ++i) network.springs.push_back({0, i, 0, 1});
  Coupled coupled(mesh, network);
  ASSERT_TRUE(coupled.state.on_tip(0));
  const double h = 1e-5;
  const numerics::EnergySum sum = coupled.sum(coupled.state, 2);
  for (std::int32_t k = 0; k < 3; ++k) {
    const Eigen::Index row = coupled.state.node_row(middle) + k;
    const auto energy_at = [&](double by) {
      NetworkState state = coupled.state;
      state.move(by * Eigen::VectorXd::Unit(state.dimension(), row));
      return coupled.sum(state, 0).value;
    };
    EXPECT_NEAR((energy_at(h) - energy_at(-h)) / (2 * h), sum.gradient[row], 1e-7) << k;
  }
}

}  // namespace
}  // namespace supple::embedded
