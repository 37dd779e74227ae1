#include "supple/embedded/relaxation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "relaxation_phases.h"
#include "supple/base/error.h"
#include "supple/embedded/network_builders.h"
#include "supple/surface/exponential_map.h"
#include "supple/surface/karcher_mean.h"
#include "supple/surface/vertex_cone.h"
#include "support/expect_error.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::embedded {
namespace {

using surface::GeodesicSolver;
using surface::SurfacePoint;
using surface::TriangleMesh;

Network dual_network(const TriangleMesh& mesh, const Eigen::Vector3d& barycentric) {
  Network network;
  network.points = points_in_faces(mesh, barycentric);
  for (const auto& [a, b] : pairs_of_adjacent_faces(mesh, network.points)) network.springs.push_back({a, b, 0, 1});
  return network;
}

void expect_never_rising(const Relaxation& relaxation) {
  for (std::size_t i = 1; i < relaxation.history.size(); ++i)
    EXPECT_LE(relaxation.history[i].energy, relaxation.history[i - 1].energy * (1 + 1e-12)) << "iteration " << i;
}

TEST(Relax, AnswersWithItsBestStateIfTimeOrMemoryRunsOut) {
  const TriangleMesh mesh = testing::torus(24, 12);
  const GeodesicSolver solver(testing::share(mesh));
  Network network = dual_network(mesh, {0.2, 0.3, 0.5});
  network.fixed_points = {0, 100, 200, 300};
  RelaxationOptions options;
  options.method = RelaxationMethod::gradient_descent;
  options.max_iterations = 4;
  const Relaxation whole = relax(solver, network, options);
  ASSERT_EQ(whole.stopped, RelaxationTermination::iteration_limit);
  options.max_iterations = 10'000;
  for (const StopReason reason : {StopReason::deadline, StopReason::memory}) {
    const CancellationToken token;
    int states = 0;
    options.observer = [&](const RelaxationStep&, std::span<const SurfacePoint>, const TriangleMesh&) {
      if (++states == 5) token.request(reason);
    };
    const Relaxation best = relax(solver, network, options, {.cancellation = token});
    const bool is_late = reason == StopReason::deadline;
    EXPECT_EQ(best.stopped, is_late ? RelaxationTermination::deadline : RelaxationTermination::memory);
    EXPECT_EQ(best.iterations, 4);
    EXPECT_EQ(best.history.size(), 5U);
    EXPECT_EQ(best.energy, whole.energy);
    EXPECT_NEAR(best.network_energy, best.energy, 1e-12 * best.energy);
    for (std::size_t i = 0; i < best.points.size(); ++i)
      EXPECT_EQ(best.points[i].barycentric, whole.points[i].barycentric) << i;
    ASSERT_FALSE(best.warnings.empty());
    EXPECT_NE(best.warnings.back().find("after 4 iterations"), std::string::npos) << best.warnings.back();
  }
  const CancellationToken token;
  options.observer = [&](const RelaxationStep&, std::span<const SurfacePoint>, const TriangleMesh&) {
    token.request(StopReason::cancelled);
  };
  testing::expect_cancelled(StopReason::cancelled, [&] { relax(solver, network, options, {.cancellation = token}); });
}

TEST(Relax, ABestStateAtWhichTheSearchHadFixedPointsHasTheGradientOfAllFreeOnes) {
  const TriangleMesh mesh = testing::torus(24, 12);
  const GeodesicSolver solver(testing::share(mesh));
  Network network = checked_network(mesh, dual_network(mesh, {0.2, 0.3, 0.5}));
  const RelaxationOptions options;
  const Execution execution;
  const RelaxationContext context(solver, network, options, execution);
  std::vector<bool> half_is_fixed = context.points.fixed;
  for (std::size_t i = 0; i < half_is_fixed.size() / 2; ++i) half_is_fixed[i] = true;
  RelaxationHistory history(options);
  find_equilibrium(context, start_of(context), {.max_iterations = 2, .fixed_points = &half_is_fixed}, history,
                   execution);
  const Equilibrium best = best_of(context, history);
  EXPECT_GT(best.gradient_norm, 1.01 * history.last().gradient_norm);
  EXPECT_EQ(best.energy, history.last().energy);
  RelaxationHistory once_more(options);
  const Equilibrium whole = find_equilibrium(context, best, {.max_iterations = 0}, once_more, execution);
  EXPECT_NEAR(best.gradient_norm, whole.gradient_norm, 1e-9 * whole.gradient_norm);
}

TEST(Relax, AStarOfSpringsComesToRestAtTheKarcherMean) {
  const TriangleMesh mesh = testing::torus(24, 12);
  const GeodesicSolver solver(testing::share(mesh));
  const testing::SurfaceSampler sampler(mesh);
  RandomStream random("star", 1);
  for (int trial = 0; trial < 5; ++trial) {
    Network network;
    surface::KarcherProblem problem;
    for (int i = 0; i < 4; ++i) {
      network.points.push_back(sampler.point(random));
      problem.points.push_back(network.points.back());
      network.springs.push_back({i, 4, 0, 1.0 + i});
      problem.weights.push_back(1.0 + i);
      network.fixed_points.push_back(i);
    }
    problem.start = network.points.front();
    problem.tolerance = 1e-12;
    network.points.push_back(network.points.front());
    RelaxationOptions options;
    options.tolerance = 1e-12;
    const Relaxation relaxed = relax(solver, network, options);
    const surface::KarcherMean mean = surface::karcher_mean(solver, problem);
    EXPECT_EQ(relaxed.stopped, RelaxationTermination::converged);
    expect_never_rising(relaxed);
    // E is 2 (sum of weights) times the objective of the Karcher mean.
    EXPECT_NEAR(relaxed.energy, 20 * mean.objective, 1e-9 * relaxed.energy);
    EXPECT_LT((surface::position(mesh, relaxed.points[4]) - mean.position).norm(), 1e-8);
  }
}

TEST(Relax, NetworksConvergeQuadraticallyFromPointsNearVerticesAndOnEdges) {
  for (const Eigen::Vector3d& start :
       {Eigen::Vector3d(0.99, 1e-6, 1 - 0.99 - 1e-6), Eigen::Vector3d(0.5, 0.5 - 1e-6, 1e-6)}) {
    const TriangleMesh mesh = testing::torus(24, 12);
    const GeodesicSolver solver(testing::share(mesh));
    const Relaxation relaxed = relax(solver, dual_network(mesh, start));
    EXPECT_EQ(relaxed.stopped, RelaxationTermination::converged);
    EXPECT_LT(relaxed.gradient_norm, 1e-9 * mesh.diagonal());
    expect_never_rising(relaxed);
    // The last iterations converge quadratically, down to rounding.
    const auto& history = relaxed.history;
    ASSERT_GE(history.size(), 3U);
    EXPECT_LT(history.back().gradient_norm, 1e-3 * history[history.size() - 2].gradient_norm);
  }
}

TEST(Relax, AllMethodsFindTheSameEquilibrium) {
  const TriangleMesh mesh = testing::icosphere(2);
  const GeodesicSolver solver(testing::share(mesh));
  Network network;
  const testing::SurfaceSampler sampler(mesh);
  RandomStream random("methods", 1);
  for (int i = 0; i < 12; ++i) network.points.push_back(sampler.point(random));
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < i; ++j)
      if ((i + j) % 3 == 0) network.springs.push_back({j, i, 0, 1});
  network.fixed_points = {0, 1, 2, 3, 4};
  RelaxationOptions options;
  options.max_iterations = 5000;
  options.tolerance = 1e-8;
  const Relaxation newton = relax(solver, network, options);
  options.method = RelaxationMethod::lbfgs;
  const Relaxation lbfgs = relax(solver, network, options);
  options.method = RelaxationMethod::gradient_descent;
  const Relaxation descent = relax(solver, network, options);
  for (const Relaxation* relaxed : {&newton, &lbfgs, &descent}) {
    EXPECT_EQ(relaxed->stopped, RelaxationTermination::converged);
    expect_never_rising(*relaxed);
  }
  EXPECT_LT(newton.iterations, lbfgs.iterations);
  EXPECT_NEAR(lbfgs.energy, newton.energy, 1e-9 * newton.energy);
  EXPECT_NEAR(descent.energy, newton.energy, 1e-9 * newton.energy);
}

TEST(Relax, APointRestsAtASaddleVertexThatHoldsIt) {
  // Three springs of equal tension, 2.2 pi / 3 apart around a saddle vertex: no direction from it descends.
  const TriangleMesh mesh = testing::cone(12, 2.2 * std::numbers::pi, 3);
  const GeodesicSolver solver(testing::share(mesh));
  Network network;
  const surface::VertexCone cone(mesh, 0);
  for (int k = 0; k < 3; ++k) {
    const auto direction = cone.direction((k + 0.1) / 3 * cone.total_angle());
    network.points.push_back(surface::exponential_map(mesh, direction.vertex, 0.7 * direction.vector, {}).end);
    network.springs.push_back({k, 3, 0, 1});
  }
  network.fixed_points = {0, 1, 2};
  const auto aside = cone.direction(0.5);
  network.points.push_back(surface::exponential_map(mesh, aside.vertex, 0.2 * aside.vector, {}).end);
  const Relaxation relaxed = relax(solver, network);
  EXPECT_EQ(relaxed.stopped, RelaxationTermination::converged);
  EXPECT_EQ(relaxed.at_vertices, std::vector<std::int32_t>{3});
  EXPECT_LT(surface::position(mesh, relaxed.points[3]).norm(), 1e-12);
  EXPECT_NEAR(relaxed.energy, 3 * 0.49, 1e-9);
  // With one spring alone, a point that starts at the vertex leaves it.
  network.points[3] = surface::vertex_point(mesh, VertexId{0});
  network.springs = {{0, 3, 0, 1}};
  const Relaxation left = relax(solver, network);
  EXPECT_EQ(left.stopped, RelaxationTermination::converged);
  EXPECT_LT(left.energy, 1e-16);
}

TEST(Relax, PointsInOnePlaceAreJoinedOrParted) {
  const TriangleMesh mesh = testing::icosphere(2);
  const GeodesicSolver solver(testing::share(mesh));
  Network network;
  network.points.assign(3, {FaceId{11}, {0.2, 0.3, 0.5}});
  network.springs = {{0, 1, 0, 1}, {1, 2, 0.25, 1}, {0, 2, 0.25, 1}};
  network.fixed_points = {0};
  const Relaxation relaxed = relax(solver, network);
  EXPECT_EQ(relaxed.stopped, RelaxationTermination::converged);
  EXPECT_LT(relaxed.energy, 1e-15);
  EXPECT_LT(relaxed.springs[0].length, 1e-7);
  EXPECT_NEAR(relaxed.springs[1].length, 0.25, 1e-7);
}

TEST(Relax, PointsCrossManyFacesInOneStep) {
  const TriangleMesh mesh = testing::flat_grid(40, 40);
  const GeodesicSolver solver(testing::share(mesh));
  Network network;
  network.points = {
      {FaceId{0}, {0.2, 0.3, 0.5}}, {FaceId{mesh.face_count() - 1}, {0.2, 0.3, 0.5}}, {FaceId{5}, {0.2, 0.3, 0.5}}};
  network.springs = {{0, 2, 0, 1}, {1, 2, 0, 3}};
  network.fixed_points = {0, 1};
  const Relaxation relaxed = relax(solver, network);
  EXPECT_EQ(relaxed.iterations, 1) << "the energy of a flat sheet is quadratic";
  const Eigen::Vector3d expected =
      0.25 * surface::position(mesh, network.points[0]) + 0.75 * surface::position(mesh, network.points[1]);
  EXPECT_LT((surface::position(mesh, relaxed.points[2]) - expected).norm(), 1e-10);
}

TEST(Relax, ABoundaryHoldsWhatIsPulledAgainstIt) {
  // The shortest path between the fixed points of an L passes its inner corner, where the middle point comes to rest.
  const TriangleMesh mesh = testing::l_shape(4);
  const GeodesicSolver solver(testing::share(mesh));
  Network network;
  const auto nearest = [&](const Eigen::Vector3d& at) {
    std::int32_t best = 0;
    for (std::int32_t v = 0; v < mesh.vertex_count(); ++v)
      if ((mesh.positions()[static_cast<std::size_t>(v)] - at).norm() <
          (mesh.positions()[static_cast<std::size_t>(best)] - at).norm())
        best = v;
    return surface::vertex_point(mesh, VertexId{best});
  };
  network.points = {nearest({2, 0.5, 0}), nearest({0.5, 2, 0}), {FaceId{0}, {0.2, 0.3, 0.5}}};
  network.springs = {{0, 2, 0, 1}, {1, 2, 0, 1}};
  network.fixed_points = {0, 1};
  const Relaxation relaxed = relax(solver, network);
  EXPECT_EQ(relaxed.stopped, RelaxationTermination::converged);
  EXPECT_LT((surface::position(mesh, relaxed.points[2]) - Eigen::Vector3d(1, 1, 0)).norm(), 1e-6);
}

TEST(Relax, AMembraneThatSpreadsRestsAgainstTheBorder) {
  const TriangleMesh mesh = testing::saddle(6);
  const GeodesicSolver solver(testing::share(mesh));
  Network network;
  network.points = poisson_disk_points(solver, 0.5, 1);
  network.triangles = membrane_at_rest(solver, network.points, triangulate(solver, network.points).triangles, 1.3);
  const Relaxation relaxed = relax(solver, network, {.max_iterations = 300});
  EXPECT_EQ(relaxed.stopped, RelaxationTermination::converged);
  EXPECT_LE(relaxed.gradient_norm, relaxed.gradient_tolerance);
  // Some points come to rest at the boundary, and leave it when the membrane is as large as before.
  const auto on_edges = [&](const std::vector<SurfacePoint>& points) {
    return std::ranges::count_if(points, [&](const SurfacePoint& point) {
      for (int corner = 0; corner < 3; ++corner)
        if (point.barycentric[corner] <= 1e-12 && mesh.twin(3 * index(point.face) + (corner + 1) % 3) < 0) return true;
      return false;
    });
  };
  EXPECT_GE(on_edges(relaxed.points), 3);
  network.points = relaxed.points;
  for (auto& triangle : network.triangles)
    for (double& length : triangle.rest_lengths) length *= 0.7 / 1.3;
  const Relaxation smaller = relax(solver, network, {.max_iterations = 300});
  EXPECT_EQ(smaller.stopped, RelaxationTermination::converged);
  EXPECT_EQ(on_edges(smaller.points), 0);
}

TEST(Relax, SpringsUnderCompressionAreToldAndStopAtTheCutLocus) {
  // The rest length exceeds all distances on the sphere: the free point moves to the antipode of the fixed one.
  const TriangleMesh mesh = testing::icosphere(3);
  const GeodesicSolver solver(testing::share(mesh));
  Network network;
  network.points = {{FaceId{0}, {0.2, 0.3, 0.5}}, {FaceId{0}, {0.4, 0.3, 0.3}}};
  network.springs = {{0, 1, 4, 1}};
  network.fixed_points = {0};
  const Relaxation relaxed = relax(solver, network);
  EXPECT_TRUE(relaxed.springs[0].compressed);
  EXPECT_FALSE(relaxed.warnings.empty());
  EXPECT_GT(relaxed.springs[0].length, 3.0);
  EXPECT_TRUE(relaxed.stopped == RelaxationTermination::cut_locus ||
              relaxed.stopped == RelaxationTermination::converged)
      << to_string(relaxed.stopped);
  expect_never_rising(relaxed);
  // A rest length that fits on the sphere is reached.
  network.springs[0].rest_length = 1.5;
  const Relaxation grown = relax(solver, network);
  EXPECT_EQ(grown.stopped, RelaxationTermination::converged);
  EXPECT_NEAR(grown.springs[0].length, 1.5, 1e-8);
  EXPECT_FALSE(grown.springs[0].compressed);
}

TEST(Relax, PointsThatNothingHoldsStayAndPartsAreIndependent) {
  const TriangleMesh mesh = testing::two_components();
  const GeodesicSolver solver(testing::share(mesh));
  Network network;
  const testing::SurfaceSampler sampler(mesh);
  RandomStream random("parts", 1);
  for (int i = 0; i < 2; ++i) network.points.push_back({FaceId{i}, {0.2, 0.3, 0.5}});
  for (int i = 0; i < 2; ++i) network.points.push_back({FaceId{mesh.face_count() - 1 - 9 * i}, {0.2, 0.3, 0.5}});
  network.points.push_back(sampler.point(random));
  network.springs = {{0, 1, 0, 1}, {2, 3, 0, 1}, {0, 4, 1, 0}};
  const Relaxation relaxed = relax(solver, network);
  EXPECT_EQ(relaxed.stopped, RelaxationTermination::converged);
  EXPECT_EQ(relaxed.loose_points, std::vector<std::int32_t>{4});
  EXPECT_EQ(relaxed.points[4].barycentric, network.points[4].barycentric);
  EXPECT_LT(relaxed.springs[0].length + relaxed.springs[1].length, 1e-8);
  ASSERT_EQ(relaxed.warnings.size(), 1U);
}

TEST(Relax, SliversAndNeedlesDoNotStopIt) {
  for (const TriangleMesh& mesh : {testing::needle_cylinder(), testing::sliver_sphere()}) {
    const GeodesicSolver solver(testing::share(mesh));
    const Relaxation relaxed = relax(solver, dual_network(mesh, {0.3, 0.3, 0.4}), {.max_iterations = 500});
    expect_never_rising(relaxed);
    EXPECT_EQ(relaxed.stopped, RelaxationTermination::converged);
  }
}

TEST(Relax, TellsEveryStateOnTheWay) {
  const TriangleMesh mesh = testing::torus(16, 8);
  const GeodesicSolver solver(testing::share(mesh));
  std::vector<double> energies;
  std::size_t points = 0;
  RelaxationOptions options;
  options.paths = true;
  options.observer = [&](const RelaxationStep& step, std::span<const SurfacePoint> at, const surface::TriangleMesh&) {
    energies.push_back(step.energy);
    points = at.size();
  };
  CostLedger cost;
  const Relaxation relaxed = relax(solver, dual_network(mesh, {0.6, 0.2, 0.2}), options, {.cost = &cost});
  ASSERT_EQ(energies.size(), relaxed.history.size());
  EXPECT_EQ(points, relaxed.points.size());
  EXPECT_EQ(static_cast<std::size_t>(relaxed.iterations) + 1, relaxed.history.size());
  double sum = 0;
  for (std::size_t i = 0; i < relaxed.springs.size(); ++i) {
    sum += relaxed.springs[i].energy;
    ASSERT_GE(relaxed.springs[i].path.size(), 2U);
  }
  EXPECT_NEAR(sum, relaxed.energy, 1e-12 * sum);
  std::vector<std::string> effects;
  for (const auto& effect : cost.effects()) effects.push_back(effect.name);
  for (const char* name : {"geodesic_springs", "mollifier", "kept_strips"})
    EXPECT_NE(std::ranges::find(effects, name), effects.end()) << name;
}

TEST(Relax, KeptStripsAndTheirAbsenceGiveTheSameAnswer) {
  const TriangleMesh mesh = testing::genus3(2);
  const GeodesicSolver solver(testing::share(mesh));
  const Network network = dual_network(mesh, {0.2, 0.2, 0.6});
  RelaxationOptions options;
  const Relaxation kept = relax(solver, network, options);
  options.kept_strips = Switch::off;
  const Relaxation searched = relax(solver, network, options);
  EXPECT_EQ(kept.stopped, searched.stopped);
  EXPECT_NEAR(kept.energy, searched.energy, 1e-9 * searched.energy);
}

TEST(Relax, TellsTheLengthAndTheEnergyOfEachSpring) {
  const TriangleMesh mesh = testing::torus(12, 8);
  const GeodesicSolver solver(testing::share(mesh));
  Network network = dual_network(mesh, {0.3, 0.3, 0.4});
  network.fixed_points = {0, 40, 90};
  for (const SpringLength kind : {SpringLength::geodesic, SpringLength::euclidean}) {
    RelaxationOptions options;
    options.spring_length = kind;
    options.max_iterations = 2;
    options.paths = true;
    const Relaxation relaxed = relax(solver, network, options);
    double energy = 0;
    for (std::size_t i = 0; i < network.springs.size(); ++i) {
      const SurfacePoint& from = relaxed.points[static_cast<std::size_t>(network.springs[i].from)];
      const SurfacePoint& to = relaxed.points[static_cast<std::size_t>(network.springs[i].to)];
      const double length = kind == SpringLength::geodesic
                                ? solver.distance(from, to)
                                : (surface::position(mesh, from) - surface::position(mesh, to)).norm();
      EXPECT_NEAR(relaxed.springs[i].length, length, 1e-12);
      EXPECT_NEAR(relaxed.springs[i].energy, length * length, 1e-12);
      EXPECT_GE(relaxed.springs[i].path.size(), 2U);
      energy += relaxed.springs[i].energy;
    }
    EXPECT_NEAR(energy, relaxed.energy, 1e-11 * energy);
  }
}

TEST(Relax, RefusesOptionsOutOfRangeAndStopsWhenAsked) {
  const TriangleMesh mesh = testing::icosphere(1);
  const GeodesicSolver solver(testing::share(mesh));
  const Network network = dual_network(mesh, {0.3, 0.3, 0.4});
  EXPECT_THROW(relax(solver, network, {.tolerance = -1}), Error);
  EXPECT_THROW(relax(solver, network, {.max_iterations = -1}), Error);
  EXPECT_THROW(relax(solver, network, {.mollifier_length = 0.6}), Error);
  EXPECT_EQ(relax(solver, network, {.max_iterations = 0}).iterations, 0);
  Execution execution;
  execution.cancellation.request(StopReason::cancelled);
  EXPECT_ANY_THROW(relax(solver, network, {}, execution));
}

TEST(Relax, SpringsWithoutWeightHoldNothing) {
  const TriangleMesh mesh = testing::icosphere(2);
  const GeodesicSolver solver(testing::share(mesh));
  for (const bool first : {true, false}) {
    Network network;
    network.points = {{FaceId{0}, {0.2, 0.3, 0.5}}, {FaceId{9}, {0.2, 0.3, 0.5}}, {FaceId{40}, {0.2, 0.3, 0.5}}};
    network.springs = {{1, 2, 0, 1}, {first ? 0 : 1, first ? 1 : 0, 0.1, 0}};
    network.fixed_points = {2};
    EXPECT_EQ(relax(solver, network).loose_points, std::vector<std::int32_t>{0}) << first;
  }
}

TEST(Relax, TakesTheSameStepsWhateverTheUnitOfLength) {
  std::vector<Relaxation> relaxed;
  for (const double unit : {1.0, 1000.0}) {
    const TriangleMesh mesh = testing::torus(24, 12, unit, 0.4 * unit);
    const GeodesicSolver solver(testing::share(mesh));
    Network network = dual_network(mesh, {0.2, 0.3, 0.5});
    network.fixed_points = {0};
    RelaxationOptions options;
    options.tolerance = 1e-3;
    relaxed.push_back(relax(solver, network, options));
    EXPECT_EQ(relaxed.back().stopped, RelaxationTermination::converged);
    EXPECT_LE(relaxed.back().gradient_norm, 1e-3 * mesh.diagonal());
    EXPECT_GT(relaxed.back().history.front().gradient_norm, 1e-3 * mesh.diagonal());
  }
  EXPECT_EQ(relaxed[0].iterations, relaxed[1].iterations);
  EXPECT_NEAR(1e6 * relaxed[0].energy, relaxed[1].energy, 1e-6 * relaxed[1].energy);
}

TEST(Relax, RefusesSpringsOfInfiniteEnergyAsThatAndNotAsCollapsedTriangles) {
  const TriangleMesh mesh = testing::torus(24, 12, 100, 40);
  const GeodesicSolver solver(testing::share(mesh));
  Network network;
  network.points = {{FaceId{0}, {0.2, 0.3, 0.5}}, {FaceId{200}, {0.2, 0.3, 0.5}}};
  network.springs = {{0, 1, 0, 1.7e308}};
  try {
    relax(solver, network);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "minimizer.not_finite");
  }
}

TEST(Relax, StraightSpringsHaveNoCutLocus) {
  const TriangleMesh mesh = testing::icosphere(2);
  const GeodesicSolver solver(testing::share(mesh));
  const Relaxation relaxed = relax(solver, dual_network(mesh, {0.2, 0.3, 0.5}),
                                   {.spring_length = SpringLength::euclidean, .max_iterations = 1});
  for (const SpringState& spring : relaxed.springs) EXPECT_FALSE(spring.at_cut_locus);
}

}  // namespace
}  // namespace supple::embedded
