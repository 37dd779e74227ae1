#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "host_model.h"
#include "moved_supports.h"
#include "network_search.h"
#include "supple/base/cost_ledger.h"
#include "supple/base/threads.h"
#include "supple/embedded/network_builders.h"
#include "supple/embedded/relaxation.h"
#include "support/expect_error.h"
#include "support/nearest_point.h"
#include "support/shapes.h"

namespace supple::embedded {
namespace {

using Eigen::Vector3d;
using surface::GeodesicSolver;
using surface::TriangleMesh;
using testing::expect_error;

/// A bar of unit cross-section along x, from 0 to 3, with chains of springs along it.
struct Bar {
  explicit Bar(int n = 3) {
    std::vector<Vector3d> positions = testing::cube(n).positions();
    for (Vector3d& p : positions) p.x() *= 3;
    mesh = testing::share(testing::cube(n).with_positions(std::move(positions)));
    solver = std::make_unique<GeodesicSolver>(mesh);
    network.points = poisson_disk_points(*solver, 0.9, 1);
    for (const auto& [a, b] : triangulate(*solver, network.points).edges)
      network.springs.push_back({a, b,
                                 0.9 * solver->distance(network.points[static_cast<std::size_t>(a)],
                                                        network.points[static_cast<std::size_t>(b)]),
                                 0.5});
  }

  template <class Where>
  std::vector<std::int32_t> vertices_where(const Where& where) const {
    std::vector<std::int32_t> found;
    for (std::int32_t i = 0; i < mesh->vertex_count(); ++i)
      if (where(mesh->positions()[i])) found.push_back(i);
    return found;
  }
  std::vector<std::int32_t> left() const {
    return vertices_where([](const Vector3d& p) { return p.x() < 1e-9; });
  }
  /// The vertices of the right end, with `stops` positions each. `place` gives the position for a fraction of the
  /// motion.
  template <class Place>
  std::vector<MovedVertex> right(int stops, const Place& place) const {
    std::vector<MovedVertex> moved;
    for (const std::int32_t i : vertices_where([](const Vector3d& p) { return p.x() > 3 - 1e-9; })) {
      MovedVertex& one = moved.emplace_back(MovedVertex{i});
      for (int k = 1; k <= stops; ++k)
        one.positions.push_back(place(mesh->positions()[i], static_cast<double>(k) / stops));
    }
    return moved;
  }

  std::shared_ptr<const TriangleMesh> mesh;
  std::unique_ptr<GeodesicSolver> solver;
  Network network;
};

bool says_how_far(const Relaxation& found) {
  return std::any_of(found.warnings.begin(), found.warnings.end(),
                     [](const std::string& warning) { return warning.rfind("Moved vertices came ", 0) == 0; });
}

Vector3d lifted(const Vector3d& p, double share) { return p + share * Vector3d(0.3, 0, 0.8); }

TEST(MovedVertices, ComeToTheirPositionsAndTheRestOfTheHostAndTheNetworkFollow) {
  const Bar bar;
  const auto check = [&](auto host) {
    host.fixed_vertices = bar.left();
    host.moved_vertices = bar.right(1, lifted);
    CostLedger cost;
    const Relaxation found = relax(*bar.solver, bar.network, {.host = host}, {.cost = &cost});
    EXPECT_EQ(found.stopped, RelaxationTermination::converged);
    EXPECT_LE(found.gradient_norm, found.gradient_tolerance);
    ASSERT_EQ(found.stops.size(), 1U);
    EXPECT_EQ(found.stops[0].reached, 1);
    EXPECT_EQ(found.energy, found.stops[0].energy);
    for (const MovedVertex& one : host.moved_vertices)
      EXPECT_LT((found.host.vertices[static_cast<std::size_t>(one.vertex)] - one.positions[0]).norm(), 1e-14);
    for (const std::int32_t i : host.fixed_vertices)
      EXPECT_EQ(found.host.vertices[static_cast<std::size_t>(i)], bar.mesh->positions()[i]);
    EXPECT_FALSE(says_how_far(found));
    EXPECT_GE(found.host.largest_displacement, std::hypot(0.3, 0.8) - 1e-12);
    bool billed = false;
    for (const auto& effect : cost.effects()) billed = billed || (effect.name == "moved_vertices" && effect.ran);
    EXPECT_TRUE(billed);
    // The number of positions does not change the end.
    host.moved_vertices = bar.right(4, lifted);
    const Relaxation slow = relax(*bar.solver, bar.network, {.host = host});
    EXPECT_EQ(slow.stopped, RelaxationTermination::converged);
    EXPECT_EQ(slow.stops.size(), 4U);
    EXPECT_NEAR(slow.energy, found.energy, 1e-8 * found.energy);
    // The iterations are those at the start and those of every load increment.
    int iterations = 0;
    for (const LoadIncrement& stop : slow.stops) iterations += stop.iterations;
    EXPECT_GT(slow.iterations, iterations);
    EXPECT_GE(static_cast<int>(slow.history.size()), slow.iterations);
    // The network is in equilibrium on the host at its end.
    const GeodesicSolver there(testing::share(bar.mesh->with_positions(found.host.vertices)));
    Network again = bar.network;
    again.points = found.points;
    EXPECT_NEAR(relax(there, again, {.max_iterations = 0}).energy, found.network_energy, 1e-10 * found.network_energy);
  };
  check(ShellHost{.thickness = 0.1, .youngs_modulus = 500, .poisson_ratio = 0.3});
  check(SolidHost{.youngs_modulus = 20, .poisson_ratio = 0.3, .element_size = 0.5});
}

TEST(MovedVertices, ThatGoTheWayOfARigidBodyTakeAllAlongWithoutAChangeOfEnergy) {
  const Bar bar;
  const Eigen::AngleAxisd turn(0.7, Vector3d(1, 2, 3).normalized());
  SolidHost host{.youngs_modulus = 20, .poisson_ratio = 0.3, .element_size = 0.5};
  for (const std::int32_t i : bar.left()) host.moved_vertices.push_back({i, {bar.mesh->positions()[i]}});
  const Relaxation before = relax(*bar.solver, bar.network, {.host = host});
  for (MovedVertex& one : host.moved_vertices) one.positions[0] = turn * one.positions[0] + Vector3d(5, -3, 2);
  const Relaxation after = relax(*bar.solver, bar.network, {.host = host});
  EXPECT_EQ(before.stopped, RelaxationTermination::converged);
  EXPECT_EQ(after.stopped, RelaxationTermination::converged);
  EXPECT_NEAR(after.energy, before.energy, 1e-9 * before.energy);
  for (std::size_t i = 0; i < before.host.vertices.size(); ++i)
    EXPECT_LT((turn * before.host.vertices[i] + Vector3d(5, -3, 2) - after.host.vertices[i]).norm(), 1e-6);
}

TEST(MovedVertices, WithFewerPositionsThanOthersStayAtTheirLast) {
  const Bar bar(2);
  ShellHost host{.thickness = 0.1, .youngs_modulus = 500, .poisson_ratio = 0.3};
  host.fixed_vertices = bar.left();
  host.moved_vertices = bar.right(3, lifted);
  host.moved_vertices[0].positions.resize(1);
  const Vector3d last = host.moved_vertices[0].positions[0];
  const Relaxation found = relax(*bar.solver, bar.network, {.host = host});
  EXPECT_EQ(found.stops.size(), 3U);
  EXPECT_LT((found.host.vertices[static_cast<std::size_t>(host.moved_vertices[0].vertex)] - last).norm(), 1e-14);
}

TEST(MovedVertices, AreFollowedOnTheTangentToThePathOfEquilibria) {
  const Bar bar;
  SolidHost host{.youngs_modulus = 20, .poisson_ratio = 0.3, .element_size = 0.5};
  host.fixed_vertices = bar.left();
  host.moved_vertices = bar.right(1, lifted);
  const Relaxation rest = relax(*bar.solver, bar.network,
                                {.host = SolidHost{.youngs_modulus = 20,
                                                   .poisson_ratio = 0.3,
                                                   .element_size = 0.5,
                                                   .fixed_vertices =
                                                       [&] {
                                                         std::vector<std::int32_t> all = bar.left();
                                                         for (const MovedVertex& one : host.moved_vertices)
                                                           all.push_back(one.vertex);
                                                         return all;
                                                       }()},
                                 .tolerance = 1e-13});
  const HostModel model(*bar.mesh, host, {});
  Eigen::VectorXd nodes(model.nodes().size());
  Eigen::Index row = 0;
  for (const auto* part : {&rest.host.vertices, &rest.host.inside})
    for (const Vector3d& node : *part) {
      nodes.segment<3>(row) = node;
      row += 3;
    }
  const NetworkState state(
      std::make_shared<GeodesicSolver>(testing::share(bar.mesh->with_positions(rest.host.vertices))), rest.points,
      nodes);
  numerics::System<NetworkState>::Terms terms = model.terms();
  terms.push_back(network_term(*bar.solver, bar.network, std::vector<bool>(bar.network.points.size(), false)).energy);
  std::vector<bool> held(2 * bar.network.points.size(), false);
  held.insert(held.end(), model.fixed().begin(), model.fixed().end());
  numerics::System<NetworkState> system(state, terms, numerics::Unknowns(held));
  ASSERT_LT(system.evaluate(1).gradient.norm(), 1e-10);
  MovedSupports scene(system, model, 1e-9);
  scene.set_target(1);
  scene.begin_step();
  // The gradient after a step along the tangent is of second order in the step.
  double last = 0;
  for (const double share : {1e-2, 1e-3, 1e-4}) {
    ASSERT_TRUE(scene.predict(share));
    EXPECT_EQ(scene.load(), share);
    const double unbalanced = system.evaluate(1).gradient.norm();
    if (last > 0) {
      EXPECT_NEAR(unbalanced / last, 1e-2, 2e-3) << share;
    }
    last = unbalanced;
  }
}

TEST(MovedVertices, LeavePointsThatHardlyAnythingHoldsInTheirPlaces) {
  Bar bar;
  // A chain whose rest length is almost its length: points have next to no stiffness across it.
  bar.network = {};
  for (const double x : {0.31, 0.93, 1.71, 2.6})
    bar.network.points.push_back(testing::nearest_point(*bar.mesh, {x, 0.52, 1}));
  for (std::int32_t i = 0; i < 3; ++i)
    bar.network.springs.push_back(
        {i, i + 1,
         (1 - 1e-13) * bar.solver->distance(bar.network.points[static_cast<std::size_t>(i)],
                                            bar.network.points[static_cast<std::size_t>(i) + 1]),
         1});
  bar.network.fixed_points = {0, 3};
  SolidHost host{.youngs_modulus = 20, .poisson_ratio = 0.3, .element_size = 0.5};
  host.fixed_vertices = bar.left();
  host.moved_vertices = bar.right(2, lifted);
  const Relaxation found = relax(*bar.solver, bar.network, {.host = host});
  EXPECT_EQ(found.stops.size(), 2U);
  EXPECT_EQ(found.stops.back().reached, 1);
}

TEST(MovedVertices, TakeABranchThatIsStable) {
  const Bar bar(2);
  SolidHost host{.youngs_modulus = 20, .poisson_ratio = 0.3, .element_size = 0.5};
  host.fixed_vertices = bar.left();
  host.moved_vertices = bar.right(1, lifted);
  const HostModel model(*bar.mesh, host, {});
  std::vector<bool> held(model.fixed());
  const auto stable_at = [&](double share) {
    Eigen::VectorXd nodes = model.nodes();
    for (Eigen::Index i = 0; i < nodes.size(); i += 3) nodes[i] *= 1 - share;
    std::vector<Vector3d> positions(static_cast<std::size_t>(bar.mesh->vertex_count()));
    for (std::size_t i = 0; i < positions.size(); ++i)
      positions[i] = nodes.segment<3>(3 * static_cast<Eigen::Index>(i));
    const NetworkState state(
        std::make_shared<GeodesicSolver>(testing::share(bar.mesh->with_positions(std::move(positions)))), {}, nodes);
    numerics::System<NetworkState> system(state, model.terms(), numerics::Unknowns(held));
    MovedSupports scene(system, model, 1e-9);
    numerics::MinimizerResult result;
    result.indefinite = true;
    return scene.finish(result);
  };
  EXPECT_TRUE(stable_at(0));
  // A straight column that is half as long would buckle.
  EXPECT_FALSE(stable_at(0.5));
}

TEST(MovedVertices, GoAsFarAsElementsKeepTheirVolumeAndSayHowFar) {
  const Bar bar(2);
  const auto check = [&](auto host) {
    host.fixed_vertices = bar.left();
    // The end would become its mirror image, and would be flat halfway.
    host.moved_vertices = bar.right(2, [](const Vector3d& p, double share) -> Vector3d {
      return {p.x(), p.y() - share * 4 * (p.y() - 0.5), p.z()};
    });
    const Relaxation found = relax(*bar.solver, bar.network, {.host = host});
    ASSERT_GE(found.stops.size(), 1U);
    ASSERT_LE(found.stops.size(), 2U);
    const LoadIncrement& last = found.stops.back();
    EXPECT_LT(last.reached, 1);
    EXPECT_NE(last.stopped, RelaxationTermination::converged);
    EXPECT_EQ(found.stopped, last.stopped);
    EXPECT_TRUE(says_how_far(found));
    EXPECT_TRUE(std::isfinite(found.energy));
    for (const auto& nodes : found.host.tetrahedra) {
      const auto at = [&](int k) -> const Vector3d& {
        const auto node = static_cast<std::size_t>(nodes[static_cast<std::size_t>(k)]);
        return node < found.host.vertices.size() ? found.host.vertices[node]
                                                 : found.host.inside[node - found.host.vertices.size()];
      };
      EXPECT_GT((at(1) - at(0)).dot((at(2) - at(0)).cross(at(3) - at(0))), 0);
    }
  };
  check(SolidHost{.youngs_modulus = 20, .poisson_ratio = 0.3, .element_size = 0.5});
}

TEST(MovedVertices, StopWhenAskedAndTellHowFarTheyAre) {
  struct Sink : ProgressSink {
    void report(double fraction, std::string_view) override {
      EXPECT_GE(fraction, last - 1e-12);
      last = fraction;
    }
    void publish(std::string_view) override {}
    double last = 0;
  };
  const Bar bar(2);
  ShellHost host{.thickness = 0.1, .youngs_modulus = 500, .poisson_ratio = 0.3};
  host.fixed_vertices = bar.left();
  host.moved_vertices = bar.right(5, lifted);
  Sink sink;
  int states = 0;
  RelaxationOptions options{.host = host};
  options.observer = [&](const RelaxationStep&, std::span<const surface::SurfacePoint>, const TriangleMesh&) {
    ++states;
  };
  const Relaxation found = relax(*bar.solver, bar.network, options, {.progress = &sink});
  EXPECT_EQ(sink.last, 1);
  EXPECT_EQ(states, static_cast<int>(found.history.size()));
  const int at_rest_after = found.iterations - [&] {
    int moving = 0;
    for (const LoadIncrement& stop : found.stops) moving += stop.iterations;
    return moving;
  }();
  for (const int last_state : {at_rest_after + 4, static_cast<int>(found.history.size()) - 2}) {
    for (const StopReason reason : {StopReason::cancelled, StopReason::deadline, StopReason::memory}) {
      Execution execution;
      CostLedger cost;
      execution.cost = &cost;
      states = 0;
      options.observer = [&](const RelaxationStep&, std::span<const surface::SurfacePoint>, const TriangleMesh&) {
        if (++states == last_state) execution.cancellation.request(reason);
      };
      const auto relaxation = [&] { return relax(*bar.solver, bar.network, options, execution); };
      if (reason == StopReason::cancelled) {
        testing::expect_cancelled(reason, relaxation);
        continue;
      }
      const Relaxation best = relaxation();
      const bool is_late = reason == StopReason::deadline;
      EXPECT_EQ(best.stopped, is_late ? RelaxationTermination::deadline : RelaxationTermination::memory);
      ASSERT_LT(best.stops.size(), 5U);
      ASSERT_FALSE(best.warnings.empty());
      EXPECT_NE(best.warnings.back().find("on the way to position " + std::to_string(best.stops.size())),
                std::string::npos)
          << best.warnings.back();
      EXPECT_EQ(best.history.back().energy, found.history[best.history.size() - 1].energy);
      for (std::size_t k = 0; k < best.stops.size(); ++k) EXPECT_EQ(best.stops[k].energy, found.stops[k].energy);
      if (!best.stops.empty()) {
        EXPECT_EQ(best.energy, best.stops.back().energy);
      }
      const std::size_t last = best.stops.size();
      for (const MovedVertex& one : host.moved_vertices) {
        const auto vertex = static_cast<std::size_t>(one.vertex);
        const Vector3d expected = last == 0 ? bar.mesh->positions()[vertex] : one.positions[last - 1];
        EXPECT_LT((best.host.vertices[vertex] - expected).norm(), 1e-12);
      }
      EXPECT_TRUE(
          std::ranges::any_of(cost.effects(), [](const auto& effect) { return effect.name == "moved_vertices"; }));
      EXPECT_FALSE(execution.cancellation.requested()) << "the report goes on";
    }
  }
}

TEST(MovedVertices, HaveTheSameBitsForAnyNumberOfThreads) {
  const Bar bar(2);
  ShellHost host{.thickness = 0.1, .youngs_modulus = 500, .poisson_ratio = 0.3};
  host.fixed_vertices = bar.left();
  host.moved_vertices = bar.right(2, lifted);
  const int before = thread_count();
  std::vector<Relaxation> found;
  for (const int threads : {1, 2, 3}) {
    set_thread_count(threads);
    found.push_back(relax(*bar.solver, bar.network, {.host = host}));
  }
  set_thread_count(before);
  for (std::size_t k = 1; k < found.size(); ++k) {
    EXPECT_EQ(found[k].energy, found[0].energy);
    EXPECT_EQ(found[k].host.vertices, found[0].host.vertices);
  }
}

TEST(MovedVertices, OfWhichNoneCanGiveWayAreMovedAllTheSame) {
  const Bar bar(1);
  ShellHost host{.thickness = 0.1, .youngs_modulus = 500, .poisson_ratio = 0.3};
  for (std::int32_t i = 0; i < bar.mesh->vertex_count(); ++i)
    host.moved_vertices.push_back({i, {1.5 * bar.mesh->positions()[i]}});
  Network network = bar.network;
  for (std::size_t i = 0; i < network.points.size(); ++i) network.fixed_points.push_back(static_cast<std::int32_t>(i));
  const Relaxation found = relax(*bar.solver, network, {.host = host});
  EXPECT_EQ(found.stopped, RelaxationTermination::converged);
  EXPECT_EQ(found.stops.at(0).reached, 1);
  EXPECT_NEAR(found.host.volume_ratio, std::pow(1.5, 3), 1e-12);
}

TEST(MovedVertices, AreRefusedByNameWhereTheyMakeNoSense) {
  const Bar bar(1);
  const auto with = [&](auto host) {
    return [&bar, host = std::move(host)] { relax(*bar.solver, bar.network, {.host = host}); };
  };
  const auto places = [](const Error& error) { return testing::places(error); };
  const Vector3d here(0, 0, 0);
  const Vector3d beyond(0, std::numeric_limits<double>::infinity(), 0);
  const std::vector<MovedVertex> wrong{{1, {here}}, {2, {here, beyond}}, {-1, {here}},
                                       {2, {here}}, {800, {here}},       {3, {}}};
  const std::vector<std::string> named{"host/moved_vertices/0/vertex", "host/moved_vertices/1/positions/1",
                                       "host/moved_vertices/2/vertex", "host/moved_vertices/3/vertex",
                                       "host/moved_vertices/4/vertex", "host/moved_vertices/5/positions"};
  EXPECT_EQ(
      places(expect_error("host.moved_vertex", with(ShellHost{.fixed_vertices = {1, 0}, .moved_vertices = wrong}))),
      named);
  EXPECT_EQ(
      places(expect_error("host.moved_vertex", with(SolidHost{.fixed_vertices = {1, 0}, .moved_vertices = wrong}))),
      named);
  // Two prescribed vertices leave the rotation about their axis undetermined.
  EXPECT_EQ(
      places(expect_error("host.unsupported", with(ShellHost{.fixed_vertices = {0}, .moved_vertices = {{1, {here}}}}))),
      (std::vector<std::string>{"host/moved_vertices"}));
}

}  // namespace
}  // namespace supple::embedded
