// Accuracy of networks against time, and what their effects cost.
#include <algorithm>
#include <cmath>
#include <utility>

#include "measurement.h"
#include "network_bench.h"
#include "supple/base/threads.h"
#include "supple/embedded/network_builders.h"
#include "support/shapes.h"

namespace supple::bench {
namespace {

constexpr int max_effect_iterations = 60;

/// Random points that keep a distance of `radius`, and springs along the edges of their geodesic triangulation. Every
/// `fixed_every`-th point is fixed: the others contract between these. Weights are 1 / (number of springs).
Scene random_scene(std::string name, surface::TriangleMesh mesh, double radius, std::size_t fixed_every) {
  Scene scene{std::move(name), testing::share(std::move(mesh)), {}};
  const surface::GeodesicSolver solver(scene.mesh);
  scene.network.points = embedded::poisson_disk_points(solver, radius);
  const auto edges = embedded::triangulate(solver, scene.network.points).edges;
  for (const auto& [a, b] : edges) scene.network.springs.push_back({a, b, 0, 1 / static_cast<double>(edges.size())});
  for (std::size_t i = 0; i < scene.network.points.size(); i += fixed_every)
    scene.network.fixed_points.push_back(static_cast<std::int32_t>(i));
  return scene;
}

}  // namespace

void study_network_accuracy(const NetworkSettings& settings) {
  Report report(settings.folder, "networks", "accuracy", "Error against time: the tolerance");
  Table table("networks-accuracy", {{"scene", "Scene"},
                                    {"tolerance", "Tolerance"},
                                    {"iterations", "Iterations"},
                                    {"stopped", "Stopped"},
                                    {"gradient", "\\|g\\|"},
                                    {"energy_error", "Error of E"},
                                    {"position_error", "Error of positions / D"},
                                    {"cpu_ms", "CPU ms"}});
  set_thread_count(1);
  std::vector<Scene> scenes = face_scenes(settings);
  if (!settings.brief) {
    std::erase_if(scenes, [](const Scene& scene) { return scene.name.ends_with("on edges"); });
    scenes.push_back(random_scene("three holes, held at points", testing::genus3(4), 0.12, 25));
  }
  for (const Scene& scene : scenes) {
    const surface::GeodesicSolver solver(scene.mesh);
    embedded::RelaxationOptions options;
    options.max_iterations = 1000;
    options.tolerance = 1e-14;
    const TimedRun reference = timed_run(solver, scene.network, options);
    const auto ends = positions_of(*scene.mesh, reference.result.points);
    for (int exponent = 2; exponent <= 12; ++exponent) {
      options.tolerance = std::pow(10.0, -exponent);
      const TimedRun run = fastest_run(settings.brief ? 1 : 5, true, solver, scene.network, options);
      const double energy_error = std::abs(run.result.energy / reference.result.energy - 1);
      const double position_error =
          largest_distance(positions_of(*scene.mesh, run.result.points), ends) / scene.mesh->diagonal();
      table.row({scene.name, number(options.tolerance, 1), std::to_string(run.result.iterations),
                 std::string(to_string(run.result.stopped)), number(run.result.gradient_norm, 2),
                 number(energy_error, 2), number(position_error, 2), number(1e3 * run.cpu_seconds)});
    }
  }
  report.table(table);
  report.image("networks-accuracy.svg", "Errors of energy and positions against time");
  report.write(
      "network_bench accuracy", settings.brief,
      "The option `tolerance`: converged once |g| <= tolerance * (largest weight) * D. Errors are against a run "
      "whose tolerance is 1e-14: of the energy relative to that run's, of positions the farthest that any "
      "point is off, over D. Times are of the whole call with one thread.");
}

void study_network_effects(const NetworkSettings& settings) {
  Report report(settings.folder, "networks", "effects", "What the effects cost");
  set_thread_count(1);
  Table table("networks-effects", {{"scene", "Scene"},
                                   {"kept_strips", "Kept strips"},
                                   {"mollifier", "Mollifier"},
                                   {"iterations", "Iterations"},
                                   {"stopped", "Stopped"},
                                   {"gradient", "\\|g\\|"},
                                   {"energy", "E"},
                                   {"cpu_ms", "CPU ms"},
                                   {"per_iteration", "CPU ms per iteration"}});
  for (const Scene& scene : face_scenes(settings)) {
    if (scene.name.ends_with("on edges")) continue;
    const surface::GeodesicSolver solver(scene.mesh);
    const auto row = [&](bool strips, double mollifier) {
      embedded::RelaxationOptions options;
      options.tolerance = scene.tolerance_for(1e-6);
      options.max_iterations = max_effect_iterations;
      options.kept_strips = strips ? Switch::on : Switch::off;
      options.mollifier = mollifier > 0 ? Switch::on : Switch::off;
      if (mollifier > 0) options.mollifier_length = mollifier;
      const TimedRun run = fastest_run(settings.brief || mollifier > 0 ? 1 : 5, true, solver, scene.network, options);
      const double ms = 1e3 * run.cpu_seconds;
      table.row({scene.name, strips ? "on" : "off", mollifier > 0 ? number(mollifier, 1) : "off",
                 std::to_string(run.result.iterations), std::string(to_string(run.result.stopped)),
                 number(run.result.gradient_norm, 2), number(run.result.energy, 10), number(ms),
                 number(ms / std::max(1, run.result.iterations))});
    };
    row(true, 0);
    row(false, 0);
    row(true, 1e-6);
    row(true, 1e-3);
  }
  report.table(table);
  report.write(
      "network_bench effects", settings.brief,
      "Runs to |g| < 1e-6 (at most 60 iterations) of the whole call, one thread, with each effect on and off. "
      "Kept strips never change the answer. The mollifier has no strips to unfold: it needs each path in full.");
}

}  // namespace supple::bench
