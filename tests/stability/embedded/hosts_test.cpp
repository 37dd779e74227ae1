// Networks on deformable shells and solids, where material, mesh, network or positions are extreme.
#include "host_case.h"
#include "random_springs.h"

#include <ctime>
#include <numbers>
#include <numeric>
#include <optional>

#include "supple/base/cost_ledger.h"
#include "supple/base/threads.h"
#include "support/expect_error.h"

namespace supple::embedded {
namespace {

using Eigen::Vector3d;

/// A soft shell, which its network can compress by some per cent.
ShellHost rubber() {
  return {.thickness = 0.02, .youngs_modulus = 500, .poisson_ratio = 0.4, .volume_weight = 50, .volume_scale = 1.05};
}
SolidHost foam() { return {.youngs_modulus = 20, .poisson_ratio = 0.3, .element_size = 0.4}; }

/// A ball under a network of stretched springs.
struct SqueezedBall : HostCase {
  explicit SqueezedBall(Host host, double weight = 2) : HostCase(testing::icosphere(2), std::move(host)) {
    cover(0.9, 0.6, weight);
  }
};

// Hard: a face that is stretched in one direction must shrink in the other: one mode is 5,000 times softer.
TEST(HardHosts, NearlyIncompressible) {
  ShellHost shell = rubber();
  shell.poisson_ratio = 0.4999;
  EXPECT_GT(SqueezedBall(shell).solve().host.largest_displacement, 0.01);
  SolidHost solid = foam();
  solid.poisson_ratio = 0.4999;
  const Relaxation kept = SqueezedBall(solid).solve();
  EXPECT_NEAR(kept.host.volume_ratio, 1, 2e-4);
}

// Hard: a compressed membrane drives its sides to cut loci, where the energy has a kink like a valley. No state in
// which each side follows one path is an equilibrium. The search must end with less energy, say why, and leave all
// triangles intact.
TEST(HardHosts, AMembraneUnderCompressionBlowsItsHostUp) {
  for (const Host& host : {Host(ShellHost{.thickness = 0.05, .youngs_modulus = 20, .poisson_ratio = 0.3}),
                           Host(SolidHost{.youngs_modulus = 2, .poisson_ratio = 0.3, .element_size = 0.5})}) {
    HostCase hard(testing::icosphere(1), host);
    hard.network.points = poisson_disk_points(hard.solver, 0.8, 1);
    const auto corners = triangulate(hard.solver, hard.network.points).triangles;
    hard.network.triangles = membrane_at_rest(hard.solver, hard.network.points, corners, 1.2);
    hard.network.fixed_points = {0};
    hard.options.max_iterations = 40;
    const Relaxation relaxed = relax(hard.solver, hard.network, hard.options);
    hard.check_descent(relaxed);
    EXPECT_LT(relaxed.energy, 0.7 * relaxed.history.front().energy);
    EXPECT_GT(relaxed.host.volume_ratio, 1.05);
    for (const TriangleState& triangle : relaxed.triangles) EXPECT_GT(triangle.stretches[1], 0);
    // The search oscillates across a valley, or ends in it.
    EXPECT_TRUE(relaxed.stopped == RelaxationTermination::cut_locus ||
                relaxed.stopped == RelaxationTermination::iteration_limit)
        << to_string(relaxed.stopped);
    EXPECT_LT(relaxed.history.back().step_length, 0.05);
    // Stretched instead, the same membrane reaches an equilibrium and compresses its host.
    hard.network.triangles = membrane_at_rest(hard.solver, hard.network.points, corners, 0.9);
    hard.options.max_iterations = 200;
    EXPECT_LT(hard.solve().host.volume_ratio, 0.95);
  }
}

/// Height of a cap's pole above its rim, away from the centre; negative in a dimple.
double height_of_cap(const HostCase& hard, const Relaxation& relaxed) {
  const surface::TriangleMesh moved = hard.mesh->with_positions(relaxed.host.vertices);
  Vector3d rim = Vector3d::Zero();
  for (std::size_t i = 1; i < relaxed.points.size(); ++i)
    rim += surface::position(moved, relaxed.points[i]) / static_cast<double>(relaxed.points.size() - 1);
  Vector3d centre = Vector3d::Zero();
  for (const Vector3d& vertex : relaxed.host.vertices)
    centre += vertex / static_cast<double>(relaxed.host.vertices.size());
  return (surface::position(moved, relaxed.points[0]) - rim).dot((rim - centre).normalized());
}

// Hard: short strong springs shrink a cap of a partly deflated shell, which snaps through past an unstable state.
TEST(HardHosts, ACapThatSnapsThroughToADimple) {
  for (const bool airless : {false, true}) {
    HostCase hard(testing::icosphere(2), ShellHost{.thickness = 0.05,
                                                   .youngs_modulus = 100,
                                                   .poisson_ratio = 0.3,
                                                   .volume_weight = 20,
                                                   .volume_scale = airless ? 0.7 : 0.95});
    hard.network.points.push_back(hard.near(0.01, 0.02, 1));
    hard.network.fixed_points = {0};
    for (std::int32_t i = 1; i <= 6; ++i) {
      const double angle = i * std::numbers::pi / 3 + 0.1;
      hard.network.points.push_back(hard.near(0.6 * std::cos(angle), 0.6 * std::sin(angle), 0.8));
      hard.network.fixed_points.push_back(i);
      hard.join(0, i, 0.6, 1);
    }
    const Relaxation relaxed = hard.solve();
    EXPECT_EQ(height_of_cap(hard, relaxed) < -0.02, airless) << height_of_cap(hard, relaxed);
  }
}

// Hard: faces of aspect ratio above 1,000 are stiffer by as much in one direction, and paths cross dozens of them.
TEST(HardHosts, OnSlivers) {
  for (const Host& host : {Host(rubber()), Host(SolidHost{.youngs_modulus = 20, .poisson_ratio = 0.3})}) {
    HostCase hard(testing::sliver_sphere(24, 8, 1e-3), host);
    hard.cover(0.9, 0.6, 2);
    const Relaxation relaxed = hard.solve();
    EXPECT_GT(relaxed.host.largest_displacement, 0.01);
  }
}

// Hard: springs to the opposite side of a ball have many paths of about the same length, and the shortest changes as
// the host deforms. Springs under tension leave cut loci, compressed ones are driven to them.
TEST(HardHosts, SpringsAcrossCutLociOfAHostThatMoves) {
  for (const Host& host : {Host(rubber()), Host(foam())})
    for (const double rest_share : {0.0, 0.5, 1.2}) {
      HostCase hard(testing::icosphere(2), host);
      for (const double side : {1.0, -1.0}) {
        hard.network.points.push_back(hard.near(0.02, 0.03, side));
        hard.network.points.push_back(hard.near(side, 0.02, 0.03));
      }
      for (const double side : {1.0, -1.0}) hard.network.points.push_back(hard.near(0.02, side, 0.1));
      for (const auto& [a, b] : {Pair(0, 2), Pair(1, 3), Pair(4, 5)}) hard.join(a, b, rest_share, 0.3);
      for (const auto& [a, b] : {Pair(0, 1), Pair(2, 3), Pair(0, 4), Pair(2, 5)}) hard.join(a, b, 0.6, 1);
      hard.network.fixed_points = {0, 2};
      if (rest_share < 1) {
        hard.solve();
        continue;
      }
      const Relaxation pushed = relax(hard.solver, hard.network, hard.options);
      hard.check_descent(pushed);
      EXPECT_EQ(pushed.stopped, RelaxationTermination::cut_locus);
      EXPECT_TRUE(std::ranges::any_of(
          pushed.springs, [](const SpringState& spring) { return spring.compressed && spring.at_cut_locus; }));
    }
}

// Hard: the energy has kinks where points start, and more where they are in equilibrium.
TEST(HardHosts, StartOnVerticesAndEdges) {
  for (const Vector3d& start : {Vector3d(1, 0, 0), Vector3d(0.5, 0.5, 0), Vector3d(0.99, 1e-6, 1 - 0.99 - 1e-6)})
    for (const auto& mesh : {testing::icosphere(1), testing::genus3(1)}) {
      HostCase hard(mesh, ShellHost{.thickness = 0.1, .youngs_modulus = 100, .poisson_ratio = 0.3});
      hard.network.points = points_in_faces(*hard.mesh, start);
      for (const auto& [a, b] : pairs_of_adjacent_faces(*hard.mesh, hard.network.points))
        hard.network.springs.push_back({a, b, 0.3, 1});
      hard.network.fixed_points = {0, 10};
      const Relaxation relaxed = hard.solve();
    }
}

// Hard: the direction in which points at the same place separate is not determined, and a path without length has none.
TEST(HardHosts, TwoPointsInOnePlace) {
  for (const Host& host : {Host(rubber()), Host(foam())}) {
    SqueezedBall hard(host);
    const auto added = static_cast<std::int32_t>(hard.network.points.size());
    hard.network.points.push_back(hard.network.points[3]);
    hard.network.points.push_back(hard.network.points[3]);
    hard.network.springs.push_back({3, added, 0, 2});
    hard.network.springs.push_back({3, added + 1, 0.2, 2});
    hard.network.springs.push_back({added, 5, 0.3, 1});
    const Relaxation relaxed = hard.solve();
  }
}

/// A point with the same coordinates in space after rounding, but a geodesic distance above 0.
std::optional<surface::SurfacePoint> nearer_than_rounding(const HostCase& hard, const surface::SurfacePoint& point) {
  for (int k = 0; k < 6; ++k) {
    surface::SurfacePoint beside = point;
    beside.barycentric[k % 3] = std::nextafter(point.barycentric[k % 3], 1);
    beside.barycentric[(k + 1 + k / 3) % 3] = std::nextafter(point.barycentric[(k + 1 + k / 3) % 3], 0);
    if (surface::position(*hard.mesh, beside) == surface::position(*hard.mesh, point) &&
        hard.solver.distance(beside, point) > 0)
      return beside;
  }
  return std::nullopt;
}

// Hard: a spring's ends have the same coordinates after rounding, so that its path has a length but no direction. A
// buckling shell needs the convex Hessian, which must not divide by that length.
TEST(HardHosts, PointsNearerThanRounding) {
  SqueezedBall hard(rubber());
  const auto before = static_cast<std::int32_t>(hard.network.points.size());
  for (std::int32_t i = 1; i < before; ++i) {
    const auto beside = nearer_than_rounding(hard, hard.network.points[static_cast<std::size_t>(i)]);
    if (!beside) continue;
    hard.network.springs.push_back({i, static_cast<std::int32_t>(hard.network.points.size()), 0, 2});
    hard.network.points.push_back(*beside);
  }
  ASSERT_GT(hard.network.points.size(), static_cast<std::size_t>(before));
  hard.solve();
}

// Hard: each part can move as a whole by itself, and neither has fixed vertices.
TEST(HardHosts, PartsThatDoNotTouch) {
  for (const Host& host : {Host(ShellHost{.thickness = 0.05, .youngs_modulus = 100, .poisson_ratio = 0.3}),
                           Host(SolidHost{.youngs_modulus = 20, .poisson_ratio = 0.3})}) {
    HostCase hard(testing::two_components(), host);
    hard.cover(0.8, 0.7, 1);
    const Relaxation relaxed = hard.solve();
    EXPECT_TRUE(std::ranges::any_of(relaxed.warnings, [](const std::string& warning) {
      return warning.find("parts of the host") != std::string::npos;
    }));
  }
}

// Hard: paths run along the boundary of the surface, whose vertices are fixed.
TEST(HardHosts, OpenSurfacesHeldAtTheirBoundary) {
  for (const auto& mesh : {testing::open_hemisphere(16, 6), testing::saddle(10)}) {
    HostCase hard(mesh, ShellHost{.thickness = 0.02, .youngs_modulus = 500, .poisson_ratio = 0.4});
    std::vector<std::int32_t> boundary;
    for (std::int32_t h = 0; h < hard.mesh->halfedge_count(); ++h)
      if (hard.mesh->twin(h) < 0) boundary.push_back(hard.mesh->faces()[h / 3][h % 3]);
    std::get<ShellHost>(hard.options.host).fixed_vertices = boundary;
    hard.cover(0.4, 0, 1);
    for (std::size_t i = 3; i < hard.network.points.size(); i += 3)
      hard.network.fixed_points.push_back(static_cast<std::int32_t>(i));
    const Relaxation relaxed = hard.solve();
    for (const std::int32_t i : boundary)
      EXPECT_EQ(relaxed.host.vertices[static_cast<std::size_t>(i)], hard.mesh->positions()[i]);
    EXPECT_GT(relaxed.host.largest_displacement, 0.1);
  }
}

/// A shell so thick that its equilibrium is unique.
ShellHost thick_shell() {
  return {.thickness = 0.05, .youngs_modulus = 200, .poisson_ratio = 0.4, .volume_weight = 50};
}

// Hard: the network's forces are below the rounding of the host's forces.
TEST(HardHosts, ANetworkAHundredMillionTimesWeakerThanTheHost) {
  for (const Host& host : {Host(thick_shell()), Host(foam())}) {
    SqueezedBall hard(host, 1e-8 * 10);
    const Relaxation relaxed = hard.solve();
    EXPECT_LE(relaxed.gradient_norm, 1e-12);
    EXPECT_LT(relaxed.host.largest_displacement, 1e-7);
    // To first order the displacements are proportional to the forces.
    SqueezedBall stronger(host, 1e-7 * 10);
    EXPECT_NEAR(stronger.solve().host.largest_displacement, 10 * relaxed.host.largest_displacement,
                1e-2 * relaxed.host.largest_displacement);
  }
}

// Hard: very stiff springs on a very soft host. The Hessian is as badly conditioned, and the search follows a curved
// valley of the energy.
TEST(HardHosts, ANetworkAThousandTimesStrongerThanTheHost) {
  for (const Host& host : {Host(thick_shell()), Host(foam())}) {
    HostCase hard(testing::icosphere(2), host);
    hard.cover(0.9, 0.95, 1e4);
    hard.options.tolerance = 1e-11;
    const Relaxation relaxed = hard.solve();
    EXPECT_GT(relaxed.host.largest_displacement, 0.05);
    for (std::size_t i = 0; i < hard.network.springs.size(); ++i)
      EXPECT_NEAR(relaxed.springs[i].length, hard.network.springs[i].rest_length, 1e-2);
  }
}

template <class Host>
void expect_any_fixed_vertices(Host host) {
  const auto solved = [&](std::vector<std::int32_t> fixed) {
    host.fixed_vertices = std::move(fixed);
    SqueezedBall hard(host, 0.5);
    return hard.solve();
  };
  const Relaxation none = solved({});
  EXPECT_NEAR(solved({7}).energy, none.energy, 1e-9 * none.energy);
  const double two = solved({100, 30}).energy;
  EXPECT_GT(two, none.energy);
  EXPECT_LT(two, 1.1 * none.energy);
  std::vector<std::int32_t> all(162);
  std::iota(all.begin(), all.end(), 0);
  const Relaxation held = solved(all);
  EXPECT_GT(held.energy, none.energy);
  EXPECT_LT(held.host.largest_displacement, 1e-9);
  const SqueezedBall rigid(RigidHost{}, 0.5);
  EXPECT_NEAR(relax(rigid.solver, rigid.network).energy, held.network_energy, 1e-10 * held.network_energy);
}

// Hard: fixed vertices leave the host free to rotate, or fix it entirely.
TEST(HardHosts, NoFixedVertexOneTwoOrAll) {
  expect_any_fixed_vertices(thick_shell());
  expect_any_fixed_vertices(foam());
}

// Hard: a pressure of 10,000 times the shell's stiffness, whose rounding errors dominate those of the sum.
TEST(HardHosts, AVolumeThatIsKeptToSixDigits) {
  ShellHost shell = rubber();
  shell.volume_weight = 1e6;
  shell.volume_scale = 1;
  const Relaxation relaxed = SqueezedBall(shell).solve();
  EXPECT_NEAR(relaxed.host.volume_ratio, 1, 1e-4);
}

// Hard: a stop request in the middle of a step, during matrix assembly and searches.
TEST(HardHosts, StopInTheMiddleOfAStep) {
  for (const Host& host : {Host(rubber()), Host(foam())})
    for (const StopReason reason : {StopReason::cancelled, StopReason::deadline}) {
      SqueezedBall hard(host);
      Execution execution;
      std::clock_t asked = 0;  // CPU time, which does not depend on the load of the machine
      int states = 0;
      hard.options.observer = [&](const RelaxationStep&, std::span<const surface::SurfacePoint>,
                                  const surface::TriangleMesh&) {
        if (++states < 3) return;
        asked = std::clock();
        execution.cancellation.request(reason);
      };
      const auto relaxation = [&] { return relax(hard.solver, hard.network, hard.options, execution); };
      if (reason == StopReason::deadline)
        EXPECT_EQ(relaxation().stopped, RelaxationTermination::deadline);
      else
        testing::expect_cancelled(reason, relaxation);
      EXPECT_EQ(states, 3);
      EXPECT_LT(std::clock() - asked, 2 * CLOCKS_PER_SEC) << "a second of two processors";
    }
}

// Hard: sums over thousands of elements and factorizations run in parallel.
TEST(HardHosts, HaveTheSameBitsForOneTwoAndThreeThreads) {
  const int before = thread_count();
  for (const Host& host : {Host(rubber()), Host(foam())}) {
    SqueezedBall hard(host);
    hard.options.max_iterations = 6;
    std::vector<Relaxation> found;
    for (const int threads : {1, 2, 3}) {
      set_thread_count(threads);
      found.push_back(relax(hard.solver, hard.network, hard.options));
    }
    for (const Relaxation& other : found) {
      EXPECT_EQ(other.energy, found[0].energy);
      EXPECT_EQ(other.gradient_norm, found[0].gradient_norm);
      EXPECT_EQ(other.host.vertices, found[0].host.vertices);
      EXPECT_EQ(other.host.inside, found[0].host.inside);
      for (std::size_t i = 0; i < other.points.size(); ++i)
        EXPECT_EQ(other.points[i].barycentric, found[0].points[i].barycentric);
    }
  }
  set_thread_count(before);
}

// A host may pass through itself, and the bill must say so.
TEST(HardHosts, SayThatTheyDoNotNoticeThemselves) {
  for (const Host& host : {Host(rubber()), Host(foam())}) {
    SqueezedBall hard(host, 0.1);
    CostLedger cost;
    relax(hard.solver, hard.network, hard.options, {.cost = &cost});
    const auto effect = std::ranges::find(cost.effects(), "self_contact", &CostLedger::Effect::name);
    ASSERT_NE(effect, cost.effects().end());
    EXPECT_FALSE(effect->ran);
    EXPECT_EQ(effect->count, 0);
    EXPECT_NE(effect->why.find("touches itself"), std::string::npos) << effect->why;
  }
}

// Hard: the strains are so small that rounding is 1e-12 of the shell's energy, and no step seems to lower it.
TEST(HardHosts, StiffShellsUnderLooseSpringsConverge) {
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    SCOPED_TRACE(seed);
    RandomStream random("stiff shells", seed);
    HostCase hard(testing::torus(8 + random.below(4), 5, 1, random.uniform(0.3, 0.45)), RigidHost{});
    draw_network(hard, {.points = 8, .to_nearest = true, .shortest = 0.1, .longest = 0.6, .fixed = 1}, random);
    const double softness = std::pow(10, random.uniform(-9, -5));
    for (Spring& spring : hard.network.springs) spring.weight *= softness;
    hard.options.host = ShellHost{.thickness = 0.05, .youngs_modulus = 1 / 0.05, .poisson_ratio = 0.3};
    const Relaxation relaxed = relax(hard.solver, hard.network, hard.options);
    // On a deformable host, compressed paths are not kept at their cut loci.
    EXPECT_TRUE(relaxed.stopped == RelaxationTermination::converged ||
                relaxed.stopped == RelaxationTermination::cut_locus)
        << to_string(relaxed.stopped) << ", gradient " << relaxed.gradient_norm << " of " << relaxed.gradient_tolerance;
  }
}

}  // namespace
}  // namespace supple::embedded
