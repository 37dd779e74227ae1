// Networks on a surface that moves to almost or exactly the same shape: the equilibrium at the start, moved along, is
// the nearest one at the end.
#include <Eigen/Geometry>
#include <functional>
#include <numbers>

#include "random_springs.h"

namespace supple::embedded {
namespace {

using Eigen::Vector3d;

std::vector<Vector3d> moved(const surface::TriangleMesh& mesh, const std::function<Vector3d(const Vector3d&)>& motion) {
  std::vector<Vector3d> positions;
  for (const Vector3d& at : mesh.positions()) positions.push_back(motion(at));
  return positions;
}

std::vector<Vector3d> turned(const surface::TriangleMesh& mesh, double angle) {
  const Eigen::AngleAxisd turn(angle, Vector3d(1, 2, -1).normalized());
  return moved(mesh, [&](const Vector3d& at) -> Vector3d { return turn * at; });
}

std::vector<Vector3d> scaled(const surface::TriangleMesh& mesh, double factor) {
  return moved(mesh, [&](const Vector3d& at) -> Vector3d { return factor * at; });
}

/// The mesh with a smooth wave, whose height is a fraction of the diagonal.
std::vector<Vector3d> waved(const surface::TriangleMesh& mesh, double share) {
  const Vector3d height = share * mesh.diagonal() * Vector3d(0.2, 0.5, 1).normalized();
  return moved(mesh, [&](const Vector3d& at) -> Vector3d { return at + std::sin(at.x() + 0.3) * height; });
}

/// A network in equilibrium, which then follows its surface.
class Follower : public NetworkCase {
 public:
  using NetworkCase::NetworkCase;

  void come_to_rest() {
    options.max_iterations = 1000;
    rest = relax(solver, network, options);
    network.points = rest.points;
  }

  Relaxation follow(std::vector<std::vector<Vector3d>> positions) const {
    RelaxationOptions moving = options;
    moving.host = MovingHost{std::move(positions)};
    return relax(solver, network, moving);
  }

  void expect_no_work(const Relaxation& end, double accuracy) const {
    EXPECT_NEAR(end.energy, rest.energy, accuracy * rest.energy);
    EXPECT_EQ(jumps_of(end), 0);
    EXPECT_EQ(end.stopped, rest.stopped);
    EXPECT_LT(farthest(end.points), 1e-6 * mesh->diagonal());
  }

  static int jumps_of(const Relaxation& relaxed) {
    int jumps = 0;
    for (const LoadIncrement& stop : relaxed.stops) jumps += stop.jumps;
    return jumps;
  }

  /// The largest distance of a point from its place in `rest`.
  double farthest(const std::vector<surface::SurfacePoint>& points) const {
    double most = 0;
    for (std::size_t i = 0; i < points.size(); ++i) most = std::max(most, solver.distance(points[i], rest.points[i]));
    return most;
  }

  Relaxation rest;
};

/// Checks that a network in equilibrium follows motions that hardly change the surface.
void expect_to_follow(const Follower& hard) {
  const surface::TriangleMesh& mesh = *hard.mesh;
  hard.expect_no_work(hard.follow({mesh.positions()}), 1e-9);
  hard.expect_no_work(hard.follow({turned(mesh, 0.05), turned(mesh, 2)}), 1e-9);
  hard.expect_no_work(hard.follow({scaled(mesh, 1 + 1e-9)}), 1e-7);
  const Relaxation back = hard.follow({waved(mesh, 0.005), mesh.positions()});
  if (Follower::jumps_of(back) > 0) {
    EXPECT_TRUE(std::ranges::any_of(back.warnings, [](const std::string& warning) {
      return warning.find("the equilibrium was lost") != std::string::npos;
    }));
    return;
  }
  EXPECT_NEAR(back.energy, hard.rest.energy, 1e-6 * hard.rest.energy);
  EXPECT_LT(hard.farthest(back.points), 1e-3 * mesh.diagonal());
}

// Hard: half of the springs are compressed, and some are at their cut loci.
class FollowedSurfaces : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(FollowedSurfaces, ASpringNetworkStaysAtItsEquilibrium) {
  Follower hard(testing::torus(24, 12));
  RandomStream random("followed surfaces", GetParam());
  draw_network(hard, {}, random);
  hard.come_to_rest();
  expect_to_follow(hard);
}

INSTANTIATE_TEST_SUITE_P(Random, FollowedSurfaces, ::testing::Range<std::uint64_t>(0, 16));

// Hard: other equilibria are very near. Points that are merely carried back may return to an equilibrium that was lost,
// or leave one that was not.
TEST(FollowedSurface, LossesAreCountedAndNothingElse) {
  int back_with_jumps = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomStream random("losses on the way", seed);
    Follower hard(seed % 2 == 0 ? testing::torus(9, 5) : testing::icosphere(1));
    draw_network(hard, {.points = 14, .fixed = 2}, random);
    hard.come_to_rest();
    if (hard.rest.stopped != RelaxationTermination::converged) continue;
    const Relaxation back = hard.follow({waved(*hard.mesh, 0.02), hard.mesh->positions()});
    const double change = std::abs(back.energy - hard.rest.energy) / hard.rest.energy;
    const bool has_jumped = Follower::jumps_of(back) > 0;
    EXPECT_TRUE(has_jumped || change < 1e-6) << change;
    if (has_jumped && change < 1e-7) ++back_with_jumps;
  }
  EXPECT_LE(back_with_jumps, 2);
}

// Hard: a compressed membrane with sides at cut loci, and a stretched one, both without fixed points.
TEST(FollowedSurface, AMembraneStaysAtItsEquilibrium) {
  for (const double rest_scale : {0.8, 1.2}) {
    SCOPED_TRACE(rest_scale);
    Follower hard(testing::torus(16, 8));
    hard.cover(0.2 * hard.mesh->diagonal(), rest_scale, 3);
    hard.come_to_rest();
    expect_to_follow(hard);
  }
}

// Hard: without fixed points the network can rotate on a ball, and the Hessian is singular.
TEST(FollowedSurface, ANetworkThatCanSpinDoesNotSpin) {
  Follower hard(testing::icosphere(2));
  hard.network.points = {hard.near(1, 0.1, 0.2), hard.near(-0.3, 1, 0.1), hard.near(0.1, -0.2, 1)};
  hard.network.springs = {{0, 1, 1, 1}, {1, 2, 1.1, 1}, {2, 0, 1.2, 1}};
  hard.come_to_rest();
  const Relaxation end = hard.follow({hard.mesh->positions(), scaled(*hard.mesh, 1 + 1e-9), scaled(*hard.mesh, 1.01)});
  EXPECT_EQ(end.stopped, RelaxationTermination::converged);
  EXPECT_EQ(Follower::jumps_of(end), 0);
  EXPECT_LT(hard.farthest(end.points), 0.02 * hard.mesh->diagonal());
}

// Hard: a stretched loop is in equilibrium around the waist of a body until the waist disappears; it then slips to an
// end. It does not return when the waist does.
TEST(FollowedSurface, ALoopThatSlipsOffIsCountedAsAJump) {
  Follower hard(testing::icosphere(3));
  const auto shaped = [&](double waist) {
    return moved(*hard.mesh, [&](const Vector3d& at) -> Vector3d {
      const double width = 1 - waist * std::exp(-8 * at.z() * at.z());
      return {width * at.x(), width * at.y(), 2 * at.z()};
    });
  };
  Follower body(hard.mesh->with_positions(shaped(0.5)));
  for (int k = 0; k < 6; ++k) {
    const double angle = k * std::numbers::pi / 3 + 0.1;
    body.network.points.push_back(body.near(0.5 * std::cos(angle), 0.5 * std::sin(angle), 0.02));
  }
  for (std::int32_t k = 0; k < 6; ++k) body.network.springs.push_back({k, (k + 1) % 6, 0.2, 1});
  body.come_to_rest();
  ASSERT_EQ(body.rest.stopped, RelaxationTermination::converged);
  const auto lies_at = [&](const surface::TriangleMesh& mesh, const Relaxation& end) {
    return surface::position(mesh, end.points[0]).z();
  };
  ASSERT_LT(std::abs(lies_at(*body.mesh, body.rest)), 0.2);
  const Relaxation end = body.follow({shaped(0.25), shaped(-0.2), shaped(0.25), shaped(0.5)});
  ASSERT_EQ(end.stops.size(), 4U);
  EXPECT_GT(std::abs(lies_at(*body.mesh, end)), 0.5);
  EXPECT_EQ(end.stops[0].jumps, 0);
  EXPECT_GT(Follower::jumps_of(end), 0);
  EXPECT_NE(end.warnings.front().find("the equilibrium was lost"), std::string::npos) << end.warnings.front();
}

}  // namespace
}  // namespace supple::embedded
