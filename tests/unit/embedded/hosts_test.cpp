#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>

#include "host_model.h"
#include "supple/base/cost_ledger.h"
#include "supple/base/random.h"
#include "supple/base/threads.h"
#include "supple/embedded/export.h"
#include "supple/embedded/network_builders.h"
#include "supple/embedded/relaxation.h"
#include "support/expect_error.h"
#include "support/shapes.h"

namespace supple::embedded {
namespace {

using Eigen::Vector3d;
using surface::GeodesicSolver;
using surface::SurfacePoint;
using surface::TriangleMesh;
using testing::expect_error;

/// Points all over a surface, and springs between neighbours, with a fraction of their length at the start as the rest
/// length.
Network net_on(const GeodesicSolver& solver, double spacing, double rest_share, double weight) {
  Network network;
  network.points = poisson_disk_points(solver, spacing, 1);
  for (const auto& [a, b] : triangulate(solver, network.points).edges) {
    const double length =
        solver.distance(network.points[static_cast<std::size_t>(a)], network.points[static_cast<std::size_t>(b)]);
    network.springs.push_back({a, b, rest_share * length, weight});
  }
  network.fixed_points = {0};
  return network;
}

ShellHost soft_shell() {
  return {.thickness = 0.02, .youngs_modulus = 500, .poisson_ratio = 0.4, .volume_weight = 50, .volume_scale = 1.05};
}

double energy_of(const Relaxation& relaxation) {
  double energy = relaxation.network_energy;
  for (const auto& term : relaxation.host.terms) energy += term.energy;
  return energy;
}

void expect_equilibrium(const Relaxation& relaxation) {
  EXPECT_EQ(relaxation.stopped, RelaxationTermination::converged);
  EXPECT_LE(relaxation.gradient_norm, relaxation.gradient_tolerance);
  EXPECT_NEAR(energy_of(relaxation), relaxation.energy, 1e-10 * std::abs(relaxation.energy));
  for (std::size_t i = 1; i < relaxation.history.size(); ++i)
    EXPECT_LE(relaxation.history[i].energy, relaxation.history[i - 1].energy * (1 + 1e-13));
  // The last iterations converge quadratically, down to rounding.
  const auto& history = relaxation.history;
  ASSERT_GE(history.size(), 3U);
  EXPECT_LT(history[history.size() - 1].gradient_norm, 1e-2 * history[history.size() - 2].gradient_norm);
}

TEST(Hosts, AShellBulgesBetweenTheSpringsOfATightNetwork) {
  const GeodesicSolver solver(testing::share(testing::icosphere(3)));
  const Network network = net_on(solver, 0.9, 0.6, 2);
  CostLedger cost;
  const Relaxation found = relax(solver, network, {.host = soft_shell()}, {.cost = &cost});
  expect_equilibrium(found);
  EXPECT_EQ(found.host.terms.size(), 3U);
  // The network reduces the enclosed volume; a large volume weight preserves it.
  EXPECT_LT(found.host.volume_ratio, 1);
  ShellHost kept = soft_shell();
  kept.volume_weight = 1e5;
  const Relaxation full = relax(solver, network, {.host = kept});
  EXPECT_EQ(full.stopped, RelaxationTermination::converged);
  EXPECT_NEAR(full.host.volume_ratio, 1.05, 1e-3);
  EXPECT_GT(found.host.largest_displacement, 0.01);
  // Faces under springs are pulled inwards, and faces between them bulge.
  double least = 10;
  double most = 0;
  Vector3d center = Vector3d::Zero();
  for (const Vector3d& vertex : found.host.vertices) center += vertex / static_cast<double>(found.host.vertices.size());
  for (const Vector3d& vertex : found.host.vertices) {
    least = std::min(least, (vertex - center).norm());
    most = std::max(most, (vertex - center).norm());
  }
  EXPECT_GT(most - least, 0.02);
  const auto ran = [&](const std::string& name) {
    for (const auto& effect : cost.effects())
      if (effect.name == name) return effect.ran ? 1 : 0;
    return -1;
  };
  EXPECT_EQ(ran("shell_membrane"), 1);
  EXPECT_EQ(ran("shell_bending"), 1);
  EXPECT_EQ(ran("shell_volume"), 1);
  EXPECT_EQ(ran("self_contact"), 0);
  EXPECT_EQ(ran("mollifier"), 0);
}

TEST(Hosts, HaveTheSameEquilibriumForAnyNumberOfThreadsBitByBit) {
  const GeodesicSolver solver(testing::share(testing::icosphere(2)));
  const Network network = net_on(solver, 0.9, 0.6, 2);
  const int before = thread_count();
  std::vector<Relaxation> found;
  for (const int threads : {1, 2, 3}) {
    set_thread_count(threads);
    found.push_back(relax(solver, network, {.host = soft_shell(), .max_iterations = 8}));
  }
  set_thread_count(before);
  for (std::size_t k = 1; k < found.size(); ++k) {
    EXPECT_EQ(found[k].energy, found[0].energy);
    EXPECT_EQ(found[k].host.vertices, found[0].host.vertices);
  }
}

TEST(Hosts, AStiffOneGivesWayAsLittleAsItIsStiff) {
  const GeodesicSolver solver(testing::share(testing::icosphere(2)));
  const Network network = net_on(solver, 0.9, 0.6, 2);
  const Relaxation rigid = relax(solver, network);
  EXPECT_TRUE(rigid.host.vertices.empty());
  EXPECT_EQ(rigid.network_energy, rigid.energy);
  double last = 1;
  for (const double youngs_modulus : {1e4, 1e6, 1e8}) {
    ShellHost shell{.thickness = 0.1, .youngs_modulus = youngs_modulus, .poisson_ratio = 0.3};
    const Relaxation found = relax(solver, network, {.host = shell});
    EXPECT_EQ(found.stopped, RelaxationTermination::converged);
    EXPECT_LT(found.energy, rigid.energy);
    EXPECT_LT(found.host.largest_displacement, 0.1 * last);
    last = found.host.largest_displacement;
    EXPECT_NEAR(found.energy, rigid.energy, 300 / youngs_modulus * rigid.energy);
  }
}

TEST(Hosts, ASolidIsSqueezedAndItsFixedVerticesStay) {
  const auto mesh = testing::share(testing::icosphere(2));
  const GeodesicSolver solver(mesh);
  const Network network = net_on(solver, 0.9, 0.6, 2);
  SolidHost solid{.youngs_modulus = 20, .poisson_ratio = 0.3, .element_size = 0.4};
  for (std::int32_t i = 0; i < mesh->vertex_count(); ++i)
    if (mesh->positions()[i].z() < -0.7) solid.fixed_vertices.push_back(i);
  const Relaxation found = relax(solver, network, {.host = solid});
  expect_equilibrium(found);
  for (const std::int32_t i : solid.fixed_vertices)
    EXPECT_EQ(found.host.vertices[static_cast<std::size_t>(i)], mesh->positions()[i]);
  EXPECT_LT(found.host.volume_ratio, 1);
  EXPECT_FALSE(found.host.inside.empty());
  EXPECT_FALSE(found.host.tetrahedra.empty());
  // The file has all springs and all tetrahedra.
  const TriangleMesh moved = mesh->with_positions(found.host.vertices);
  const std::string vtu = write_vtu(moved, network, found);
  EXPECT_NE(vtu.find("Name=\"host\""), std::string::npos);
  EXPECT_NE(vtu.find("NumberOfCells=\"" + std::to_string(network.springs.size() + found.host.tetrahedra.size())),
            std::string::npos);
}

TEST(Hosts, AreHeldJustEnoughWhereNothingIsFixed) {
  // Each of the mesh's two components is constrained by itself: six coordinates of three nodes.
  const TriangleMesh mesh = testing::two_components();
  const auto held = [&](std::vector<std::int32_t> fixed) {
    const HostModel host(mesh, ShellHost{.fixed_vertices = std::move(fixed)}, {});
    return std::pair(std::count(host.fixed().begin(), host.fixed().end(), true), host.rigid_body_constraints());
  };
  EXPECT_EQ(held({}), std::pair(std::ptrdiff_t{12}, 2));
  EXPECT_EQ(held({0}), std::pair(std::ptrdiff_t{12}, 2)) << "one fixed vertex is the first of the three";
  EXPECT_EQ(held({0, 1}), std::pair(std::ptrdiff_t{6 + 1 + 6}, 2)) << "two leave a turn";
  EXPECT_EQ(held({0, 1, 2}), std::pair(std::ptrdiff_t{9 + 6}, 1));
}

TEST(Hosts, TheSupportsTakeNoForceAndTheirPlaceDoesNotMatter) {
  const auto mesh = testing::share(testing::icosphere(2));
  const GeodesicSolver solver(mesh);
  const Network network = net_on(solver, 0.9, 0.6, 2);
  ShellHost shell = soft_shell();
  const Relaxation one = relax(solver, network, {.host = shell});
  shell.fixed_vertices = {7};
  const Relaxation other = relax(solver, network, {.host = shell});
  EXPECT_EQ(one.stopped, RelaxationTermination::converged);
  EXPECT_EQ(other.stopped, RelaxationTermination::converged);
  EXPECT_NEAR(other.energy, one.energy, 1e-9 * one.energy);
  EXPECT_EQ(
      std::ranges::count_if(one.warnings, [](const std::string& warning) { return warning.find("No fixed") == 0; }), 1);
}

TEST(Hosts, RefuseWhatTheyCannotBe) {
  const GeodesicSolver closed(testing::share(testing::icosphere(1)));
  const GeodesicSolver open(testing::share(testing::open_hemisphere()));
  Network network;
  network.points = {{FaceId{0}, {0.3, 0.3, 0.4}}, {FaceId{5}, {0.3, 0.3, 0.4}}};
  network.springs = {{0, 1, 0, 1}};
  const auto with = [&](const GeodesicSolver& solver, Host host) {
    return [&solver, &network, host = std::move(host)] { relax(solver, network, {.host = host}); };
  };
  const auto places = [](const Error& error) { return testing::places(error); };
  EXPECT_EQ(places(expect_error("host.invalid", with(closed, ShellHost{.thickness = 0, .poisson_ratio = 0.5}))),
            (std::vector<std::string>{"host/thickness", "host/poisson_ratio"}));
  EXPECT_EQ(places(expect_error("host.invalid", with(closed, ShellHost{.volume_weight = -1, .volume_scale = 0}))),
            (std::vector<std::string>{"host/volume_weight", "host/volume_scale"}));
  EXPECT_EQ(places(expect_error("host.fixed_vertex", with(closed, ShellHost{.fixed_vertices = {0, 42, -1}}))),
            (std::vector<std::string>{"host/fixed_vertices/1", "host/fixed_vertices/2"}));
  expect_error("host.open_surface", with(open, ShellHost{.volume_weight = 1}));
  expect_error("solid.open_surface", with(open, SolidHost{}));
  SolidHost heavy;
  heavy.gravity = {0, 0, -1};
  heavy.fixed_vertices = {0, 1};
  expect_error("host.unsupported", with(closed, heavy));
  SolidHost regions;
  regions.regions = {{{0, 0, 0}, {1, 1, 1}, 0}, {{0, 2, 0}, {1, 1, 1}, 1}};
  EXPECT_EQ(places(expect_error("host.invalid", with(closed, regions))),
            (std::vector<std::string>{"host/regions/0/youngs_modulus", "host/regions/1/lower"}));
  EXPECT_EQ(places(expect_error("host.positions", with(closed, MovingHost{{{{0, 0, 0}}}}))),
            (std::vector<std::string>{"host/positions/0"}));
  for (const Host& host : {Host(ShellHost{}), Host(MovingHost{{closed.mesh().positions()}})}) {
    expect_error("network.invalid_option",
                 [&] { relax(closed, network, {.host = host, .spring_length = SpringLength::euclidean}); });
    expect_error("network.invalid_option", [&] { relax(closed, network, {.host = host, .mollifier = Switch::on}); });
  }
}

/// A membrane at rest on a torus that becomes longer along x in equal steps.
struct MembraneOnStretchedTorus {
  MembraneOnStretchedTorus(int steps, double strain_of_step) {
    network.points = poisson_disk_points(solver, 0.45, 1);
    network.triangles = membrane_at_rest(solver, network.points, triangulate(solver, network.points).triangles, 1);
    for (int k = 1; k <= steps; ++k) {
      auto& positions = host.positions.emplace_back(mesh->positions());
      for (Vector3d& p : positions) p.x() *= 1 + strain_of_step * k;
    }
  }

  std::shared_ptr<const TriangleMesh> mesh = testing::share(testing::torus(24, 12));
  GeodesicSolver solver{mesh};
  Network network;
  MovingHost host;
};

TEST(Hosts, AMembraneFollowsASurfaceThatMoves) {
  MembraneOnStretchedTorus scene(10, 0.05);
  auto& [mesh, solver, network, host] = scene;
  int states = 0;
  RelaxationOptions options{.host = host};
  options.observer = [&](const RelaxationStep&, std::span<const SurfacePoint>, const TriangleMesh&) { ++states; };
  const Relaxation found = relax(solver, network, options);
  EXPECT_EQ(found.stopped, RelaxationTermination::converged);
  ASSERT_EQ(found.stops.size(), 10U);
  int iterations = 0;
  for (const LoadIncrement& stop : found.stops) {
    EXPECT_EQ(stop.stopped, RelaxationTermination::converged);
    EXPECT_LE(stop.gradient_norm, found.gradient_tolerance);
    iterations += stop.iterations;
  }
  EXPECT_LT(iterations, 80);
  EXPECT_EQ(states, static_cast<int>(found.history.size()));
  EXPECT_EQ(found.host.vertices, host.positions.back());
  EXPECT_EQ(found.energy, found.stops.back().energy);
  // The end is also an equilibrium of a search on the last position alone.
  const GeodesicSolver last(testing::share(mesh->with_positions(host.positions.back())));
  network.points = found.points;
  const Relaxation again = relax(last, network, {});
  EXPECT_LE(again.iterations, 1);
  EXPECT_NEAR(again.energy, found.energy, 1e-10 * found.energy);
  // Points with the barycentric coordinates of the start have more energy.
  Network kept = network;
  kept.points = relax(solver, network, {}).points;
  EXPECT_GT(relax(last, kept, {.max_iterations = 0}).energy, found.energy);
}

TEST(Hosts, AnswerWithTheEquilibriumAtTheLastPositionIfTimeOrMemoryRunsOut) {
  const MembraneOnStretchedTorus scene(6, 0.1);
  const auto& [mesh, solver, network, host] = scene;
  RelaxationOptions options{.host = host};
  const Relaxation whole = relax(solver, network, options);
  const auto width = [](const std::vector<Vector3d>& positions) {
    double most = 0;
    for (const Vector3d& p : positions) most = std::max(most, p.x());
    return most;
  };
  for (const StopReason reason : {StopReason::deadline, StopReason::memory}) {
    // The first state on the way to the fourth position, and the first one of all.
    for (const double widest : {width(host.positions[2]) + 1e-9, 0.0}) {
      const CancellationToken token;
      options.observer = [&](const RelaxationStep&, std::span<const SurfacePoint>, const TriangleMesh& at) {
        if (width(at.positions()) > widest) token.request(reason);
      };
      const Relaxation best = relax(solver, network, options, {.cancellation = token});
      EXPECT_EQ(best.stopped,
                reason == StopReason::deadline ? RelaxationTermination::deadline : RelaxationTermination::memory);
      ASSERT_FALSE(best.warnings.empty());
      if (widest == 0) {
        EXPECT_TRUE(best.stops.empty());
        EXPECT_EQ(best.host.vertices, mesh->positions());
        EXPECT_NE(best.warnings.back().find("before the first motion."), std::string::npos) << best.warnings.back();
        continue;
      }
      ASSERT_GE(best.stops.size(), 3U);
      ASSERT_LT(best.stops.size(), 6U);
      const std::size_t last = best.stops.size() - 1;
      EXPECT_EQ(best.host.vertices, host.positions[last]);
      EXPECT_EQ(best.energy, whole.stops[last].energy);
      EXPECT_NE(best.warnings.back().find("at position " + std::to_string(last) + "."), std::string::npos)
          << best.warnings.back();
    }
  }
}

TEST(Hosts, AMovingSurfaceGoesOnWhereItsNetworkCannotFollow) {
  const auto mesh = testing::share(testing::icosphere(2));
  const GeodesicSolver solver(mesh);
  Network network = net_on(solver, 0.9, 0.6, 2);
  network.points = relax(solver, network).points;
  MovingHost host;
  for (const double stretch : {1.5, 3.0}) {
    auto& positions = host.positions.emplace_back(mesh->positions());
    for (Vector3d& p : positions) p = Vector3d(stretch * p.x(), p.y() / stretch, p.z());
  }
  // One iteration is too few for a step of any length.
  const Relaxation found = relax(solver, network, {.host = host, .max_iterations = 1});
  ASSERT_EQ(found.stops.size(), 2U);
  for (const LoadIncrement& stop : found.stops) EXPECT_EQ(stop.stopped, RelaxationTermination::iteration_limit);
  EXPECT_EQ(found.stopped, RelaxationTermination::iteration_limit);
  EXPECT_EQ(found.host.vertices, host.positions.back());
  // The points are on the surface at its last position, and have the reported energy there.
  const GeodesicSolver last(testing::share(mesh->with_positions(found.host.vertices)));
  Network there = network;
  there.points = found.points;
  EXPECT_NEAR(relax(last, there, {.max_iterations = 0}).energy, found.energy, 1e-12 * found.energy);
}

}  // namespace
}  // namespace supple::embedded
