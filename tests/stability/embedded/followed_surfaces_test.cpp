// Networks that follow a surface to where it is almost or exactly the same: the nearest equilibrium is the one that
// they are at. Half of the springs push, and some are at their cut loci.
#include "random_springs.h"

#include <Eigen/Geometry>

namespace supple::embedded {
namespace {

using Eigen::Vector3d;

std::vector<Vector3d> turned(const surface::TriangleMesh& mesh, double angle) {
  const Eigen::AngleAxisd turn(angle, Vector3d(1, 2, -1).normalized());
  std::vector<Vector3d> positions;
  for (const Vector3d& at : mesh.positions()) positions.push_back(turn * at);
  return positions;
}

std::vector<Vector3d> scaled(const surface::TriangleMesh& mesh, double factor) {
  std::vector<Vector3d> positions;
  for (const Vector3d& at : mesh.positions()) positions.push_back(factor * at);
  return positions;
}

/// A smooth wave, whose height is this share of the diagonal.
std::vector<Vector3d> waved(const surface::TriangleMesh& mesh, double share) {
  std::vector<Vector3d> positions;
  for (const Vector3d& at : mesh.positions())
    positions.push_back(at + share * mesh.diagonal() * std::sin(at.x() + 0.3) * Vector3d(0.2, 0.5, 1).normalized());
  return positions;
}

double farthest(const surface::GeodesicSolver& solver, const std::vector<surface::SurfacePoint>& a,
                const std::vector<surface::SurfacePoint>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, solver.distance(a[i], b[i]));
  return most;
}

class FollowedSurfaces : public ::testing::TestWithParam<std::uint64_t> {
 protected:
  FollowedSurfaces() : hard_(testing::torus(24, 12)) {
    RandomStream random("followed surfaces", GetParam());
    draw_network(hard_, {}, random);
    rest_ = relax(hard_.solver, hard_.network, hard_.options);
    hard_.network.points = rest_.points;
  }

  Relaxation follow(std::vector<std::vector<Vector3d>> positions) {
    hard_.options.host = MovingHost{std::move(positions)};
    return relax(hard_.solver, hard_.network, hard_.options);
  }

  int jumps_of(const Relaxation& relaxed) {
    int jumps = 0;
    for (const FollowedStop& stop : relaxed.stops) jumps += stop.jumps;
    return jumps;
  }

  NetworkCase hard_;
  Relaxation rest_;
};

TEST_P(FollowedSurfaces, ARigidTurnDoesNoWork) {
  const Relaxation end = follow({turned(*hard_.mesh, 0.05), turned(*hard_.mesh, 2)});
  EXPECT_NEAR(end.energy, rest_.energy, 1e-9 * rest_.energy);
  EXPECT_EQ(jumps_of(end), 0);
  EXPECT_LT(farthest(hard_.solver, end.points, rest_.points), 1e-6 * hard_.mesh->diagonal());
}

TEST_P(FollowedSurfaces, OneThatHardlyMovesMovesNoPoint) {
  const Relaxation end = follow({scaled(*hard_.mesh, 1), scaled(*hard_.mesh, 1 + 1e-9)});
  EXPECT_NEAR(end.energy, rest_.energy, 1e-7 * rest_.energy);
  EXPECT_EQ(jumps_of(end), 0);
  EXPECT_LT(farthest(hard_.solver, end.points, rest_.points), 1e-6 * hard_.mesh->diagonal());
}

TEST_P(FollowedSurfaces, ThereAndBackItIsWhereItWasOrSaysThatAnEquilibriumWasLost) {
  const Relaxation end = follow({waved(*hard_.mesh, 0.005), hard_.mesh->positions()});
  if (jumps_of(end) > 0) return;
  EXPECT_NEAR(end.energy, rest_.energy, 1e-7 * rest_.energy);
  EXPECT_LT(farthest(hard_.solver, end.points, rest_.points), 1e-4 * hard_.mesh->diagonal());
}

INSTANTIATE_TEST_SUITE_P(Random, FollowedSurfaces, ::testing::Range<std::uint64_t>(0, 12));

// Hard: nothing holds the network as a whole: it can spin on a ball, and the Hessian is singular.
TEST(FollowedSurface, ANetworkThatCanSpinDoesNotSpin) {
  NetworkCase hard(testing::icosphere(2));
  hard.network.points = {hard.near(1, 0.1, 0.2), hard.near(-0.3, 1, 0.1), hard.near(0.1, -0.2, 1)};
  hard.network.springs = {{0, 1, 1, 1}, {1, 2, 1.1, 1}, {2, 0, 1.2, 1}};
  hard.network.points = relax(hard.solver, hard.network, hard.options).points;
  hard.options.host = MovingHost{{scaled(*hard.mesh, 1), scaled(*hard.mesh, 1 + 1e-9), scaled(*hard.mesh, 1.01)}};
  const Relaxation end = relax(hard.solver, hard.network, hard.options);
  EXPECT_EQ(end.stopped, "converged");
  EXPECT_LT(farthest(hard.solver, end.points, hard.network.points), 0.02 * hard.mesh->diagonal());
}

}  // namespace
}  // namespace supple::embedded
