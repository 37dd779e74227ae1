// Scenes and timed runs that the studies of networks share.
#include <algorithm>
#include <utility>

#include "bill.h"
#include "measurement.h"
#include "network_bench.h"
#include "supple/embedded/network_builders.h"
#include "support/shapes.h"

namespace supple::bench {

using embedded::Network;
using surface::SurfacePoint;
using surface::TriangleMesh;

const Eigen::Vector3d near_vertex(0.99, 1e-6, 1 - 0.99 - 1e-6);
const Eigen::Vector3d on_edge(0.5, 0.5 - 1e-6, 1e-6);

double Scene::tolerance_for(double gradient) const {
  double largest = 0;
  for (const embedded::Spring& spring : network.springs) largest = std::max(largest, spring.weight);
  return gradient / (mesh->diagonal() * largest);
}

Scene face_scene(std::string name, TriangleMesh mesh, const Eigen::Vector3d& barycentric) {
  Scene scene{std::move(name), testing::share(std::move(mesh)), {}};
  scene.network.points = embedded::points_in_faces(*scene.mesh, barycentric);
  const auto pairs = embedded::pairs_of_adjacent_faces(*scene.mesh, scene.network.points);
  const double weight = 1 / (2 * static_cast<double>(pairs.size()));
  for (const auto& [a, b] : pairs) {
    scene.network.springs.push_back({a, b, 0, weight});
    scene.network.springs.push_back({b, a, 0, weight});
  }
  return scene;
}

std::vector<Scene> face_scenes(const NetworkSettings& settings) {
  std::vector<Scene> scenes;
  scenes.push_back(face_scene("torus, near vertices", testing::torus(24, 12), near_vertex));
  if (settings.brief) return scenes;
  scenes.push_back(face_scene("torus, on edges", testing::torus(24, 12), on_edge));
  scenes.push_back(face_scene("three holes, near vertices", testing::genus3(4), near_vertex));
  scenes.push_back(face_scene("three holes, on edges", testing::genus3(4), on_edge));
  scenes.push_back(face_scene("knot, near vertices", testing::trefoil_knot(80, 12), near_vertex));
  scenes.push_back(face_scene("knot, on edges", testing::trefoil_knot(80, 12), on_edge));
  return scenes;
}

TimedRun timed_run(const surface::GeodesicSolver& solver, const Network& network, embedded::RelaxationOptions options) {
  TimedRun run;
  Execution execution;
  execution.cost = &run.cost;
  // The observer's own time is subtracted.
  double cpu_apart = 0;
  double wall_apart = 0;
  const double cpu_start = cpu_seconds();
  const double wall_start = wall_seconds();
  options.observer = [&](const embedded::RelaxationStep& step, std::span<const SurfacePoint>, const TriangleMesh&) {
    const double cpu = cpu_seconds();
    const double wall = wall_seconds();
    TimedStep timed;
    timed.step = step;
    timed.cpu_seconds = cpu - cpu_apart;
    timed.wall_seconds = wall - wall_apart;
    timed.search = stage_seconds(run.cost, "search");
    timed.host_derivatives = stage_seconds(run.cost, "host_derivatives");
    timed.assembly = stage_seconds(run.cost, "assembly");
    timed.solve = stage_seconds(run.cost, "step");
    timed.motion = stage_seconds(run.cost, "motion");
    run.steps.push_back(std::move(timed));
    cpu_apart += cpu_seconds() - cpu;
    wall_apart += wall_seconds() - wall;
  };
  run.result = embedded::relax(solver, network, options, execution);
  run.cpu_seconds = cpu_seconds() - cpu_start - cpu_apart;
  run.wall_seconds = wall_seconds() - wall_start - wall_apart;
  if (run.steps.empty()) return run;
  const TimedStep start = run.steps.front();
  for (TimedStep& step : run.steps) {
    step.cpu_seconds -= start.cpu_seconds;
    step.wall_seconds -= start.wall_seconds;
    step.search -= start.search;
    step.host_derivatives -= start.host_derivatives;
    step.assembly -= start.assembly;
    step.solve -= start.solve;
    step.motion -= start.motion;
  }
  return run;
}

TimedRun fastest_run(int repetitions, bool by_cpu, const surface::GeodesicSolver& solver, const Network& network,
                     const embedded::RelaxationOptions& options) {
  TimedRun best;
  for (int i = 0; i < repetitions; ++i) {
    TimedRun run = timed_run(solver, network, options);
    const bool faster = by_cpu ? run.cpu_seconds < best.cpu_seconds : run.wall_seconds < best.wall_seconds;
    if (i == 0 || faster) best = std::move(run);
  }
  return best;
}

std::vector<Eigen::Vector3d> positions_of(const TriangleMesh& mesh, const std::vector<SurfacePoint>& points) {
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(points.size());
  for (const SurfacePoint& point : points) positions.push_back(surface::position(mesh, point));
  return positions;
}

double largest_distance(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

}  // namespace supple::bench
