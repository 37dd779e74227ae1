// Convergence from starts that are hard for others: near vertices and on edges [Thesis, fig. 3.4].
#include "network_bench.h"
#include "supple/base/threads.h"

namespace supple::bench {
namespace {

constexpr double tight_scene_gradient = 1e-12;

/// The first iteration at which |g| is below the limit, or -1.
int reached(const std::vector<TimedStep>& steps, double limit) {
  for (std::size_t i = 0; i < steps.size(); ++i)
    if (steps[i].step.gradient_norm < limit) return static_cast<int>(i);
  return -1;
}

}  // namespace

void study_network_scenes(const NetworkSettings& settings) {
  Report report(settings.folder, "networks", "scenes", "Convergence from points near vertices and on edges");
  Table table("networks-scenes", {{"scene", "Scene"},
                                  {"faces", "Faces"},
                                  {"unknowns", "Unknowns"},
                                  {"iterations_6", "Iterations to 1e-6"},
                                  {"cpu_ms_6", "CPU ms"},
                                  {"iterations_12", "Iterations to 1e-12"},
                                  {"cpu_ms_12", "CPU ms"},
                                  {"stopped", "Stopped"},
                                  {"at_vertices", "Points at vertices"},
                                  {"tail", "Last \\|g\\|"}});
  set_thread_count(1);
  std::size_t converged = 0;
  const std::vector<Scene> scenes = face_scenes(settings);
  for (const Scene& scene : scenes) {
    const surface::GeodesicSolver solver(scene.mesh);
    embedded::RelaxationOptions options;
    options.tolerance = scene.tolerance_for(tight_scene_gradient);
    options.max_iterations = 500;
    const TimedRun run = fastest_run(settings.brief ? 1 : 5, true, solver, scene.network, options);
    const auto at = [&](double limit) {
      const int i = reached(run.steps, limit);
      return std::pair<std::string, std::string>(
          i < 0 ? "-" : std::to_string(i),
          i < 0 ? "-" : number(1e3 * run.steps[static_cast<std::size_t>(i)].cpu_seconds));
    };
    const auto [iterations_6, ms_6] = at(thesis_gradient);
    const auto [iterations_12, ms_12] = at(tight_scene_gradient);
    converged += iterations_6 != "-" ? 1 : 0;
    std::string tail;
    const std::size_t count_of_steps = run.steps.size();
    for (std::size_t i = count_of_steps > 4 ? count_of_steps - 4 : 0; i < count_of_steps; ++i)
      tail += (tail.empty() ? "" : " ") + number(run.steps[i].step.gradient_norm, 2);
    table.row({scene.name, count(scene.mesh->face_count()), count(scene.unknowns()), iterations_6, ms_6, iterations_12,
               ms_12, std::string(to_string(run.result.stopped)), std::to_string(run.result.at_vertices.size()), tail});
  }
  report.target("Scenes near vertices and on edges that reach a gradient of norm below 1e-6", "all",
                std::to_string(converged) + " of " + std::to_string(scenes.size()), converged == scenes.size());
  report.table(table);
  report.write(
      "network_bench scenes", settings.brief,
      "One point in each face and springs of rest length 0 to the points of the three neighbours, two for each pair "
      "(thesis fig. 3.4), from barycentric coordinates (0.99, 1e-6, rest), *near vertices*, and (0.5, 0.5 - 1e-6, "
      "1e-6), *on edges*. Weights are 1 / (number of springs); the thesis ends at |g| < 1e-6, here the iteration goes "
      "on to 1e-12. The last column holds |g| after each of the last four iterations: where no more points cross "
      "edges it falls quadratically. Before, the equilibrium is being sought among faces: points meet saddle vertices, "
      "at which E bends sharply.");
}

}  // namespace supple::bench
