// Newton's method against L-BFGS and gradient descent (thesis fig. 3.11), and what accuracy costs.
#include <algorithm>
#include <cmath>
#include <limits>

#include "measurement.h"
#include "network_bench.h"
#include "supple/base/threads.h"
#include "support/shapes.h"

namespace supple::bench {
namespace {

using embedded::RelaxationMethod;

constexpr double goal = 1e-10;
constexpr double visible = 0.01;  ///< of the mesh's diagonal: what the thesis calls visually distinguishable

struct Method {
  RelaxationMethod method;
  const char* name;
};
constexpr Method methods[] = {{RelaxationMethod::newton, "newton"},
                              {RelaxationMethod::lbfgs, "lbfgs"},
                              {RelaxationMethod::gradient_descent, "gradient_descent"}};

std::vector<Scene> problems(const NetworkSettings& settings) {
  std::vector<Scene> scenes;
  scenes.push_back(face_scene("torus, on edges", testing::torus(24, 12), on_edge));
  if (settings.brief) return scenes;
  scenes.push_back(random_scene("three holes, held at points", testing::genus3(4), 0.12, 25));
  return scenes;
}

/// Of a long history, fewer and fewer.
bool is_drawn(std::size_t i, std::size_t last) { return i <= 60 || i == last || i % (i / 60 + 1) == 0; }

/// The iteration from which on all points stay within `visible` of where they end.
std::size_t indistinguishable(const std::vector<TimedStep>& steps, double diagonal) {
  std::size_t i = steps.size() - 1;
  while (i > 0 && largest_distance(steps[i - 1].positions, steps.back().positions) < visible * diagonal) --i;
  return i;
}

}  // namespace

void measure_methods(Report& report, const NetworkSettings& settings) {
  report.heading("Methods");
  report.text(
      "Newton's method, L-BFGS and gradient descent (Barzilai and Borwein's steps, monotone) on two problems (thesis "
      "fig. 3.11): the torus of the scenes, and random points on a surface with three holes, of which every 25th stays "
      "and the others contract between them. All use the same distances and kept strips, and end at |g| < 1e-10 or "
      "after 4,000 iterations. *Within 1 %* is the iteration from which on no point is farther than 1 % of D from "
      "where it ends. Local minima differ: E tells which one was found.");
  Table table("networks-methods", {{"problem", "Problem"},
                                   {"unknowns", "Unknowns"},
                                   {"method", "Method"},
                                   {"stopped", "Stopped"},
                                   {"iterations", "Iterations"},
                                   {"gradient", "\\|g\\|"},
                                   {"energy", "E"},
                                   {"cpu_ms", "CPU ms"},
                                   {"visible_iterations", "Within 1 %"},
                                   {"visible_ms", "CPU ms until then"}});
  Table history("networks-methods-history", {{"problem", "Problem"},
                                             {"method", "Method"},
                                             {"iteration", "Iteration"},
                                             {"cpu_ms", "CPU ms"},
                                             {"energy", "E"},
                                             {"gradient", "|g|"},
                                             {"visible", "still visibly off"}});
  set_thread_count(1);
  for (const Scene& scene : problems(settings)) {
    const surface::GeodesicSolver solver(scene.mesh);
    for (const Method& method : methods) {
      embedded::RelaxationOptions options;
      options.method = method.method;
      options.tolerance = scene.tolerance_for(goal);
      options.max_iterations = settings.brief ? 60 : 4000;
      TimedRun run = timed_run(solver, scene.network, options, true);
      for (int i = 0; i < 4 && !settings.brief && run.cpu_seconds < 0.5; ++i) {
        TimedRun again = timed_run(solver, scene.network, options, true);
        if (again.cpu_seconds < run.cpu_seconds) run = std::move(again);
      }
      const std::size_t last = run.steps.size() - 1;
      const std::size_t seen = indistinguishable(run.steps, scene.mesh->diagonal());
      table.row({scene.name, count(scene.unknowns()), method.name, run.result.stopped, count(run.result.iterations),
                 number(run.result.gradient_norm, 2), number(run.result.energy, 10),
                 number(1e3 * run.steps[last].cpu_seconds), count(static_cast<double>(seen)),
                 number(1e3 * run.steps[seen].cpu_seconds)});
      for (std::size_t i = 0; i <= last; ++i)
        if (is_drawn(i, last))
          history.row({scene.name, method.name, std::to_string(i), number(1e3 * run.steps[i].cpu_seconds, 5),
                       number(run.steps[i].step.energy, 14), number(run.steps[i].step.gradient_norm, 6),
                       i < seen ? "1" : "0"});
    }
  }
  report.table(table);
  report.data(history);
  report.image("networks-methods.svg", "The gradient's norm against iterations and time for three methods");
}

void measure_accuracy_of_networks(Report& report, const NetworkSettings& settings) {
  report.heading("Accuracy against time");
  report.text(
      "The option `tolerance`: converged once |g| <= tolerance * (largest weight) * D. Errors are against a run whose "
      "tolerance is 1e-14: of the energy relative to that run's, of positions the farthest that any point is off, over "
      "D. Times are of the whole call with one thread.");
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
    scenes.push_back(problems(settings).back());
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
      table.row({scene.name, number(options.tolerance, 1), std::to_string(run.result.iterations), run.result.stopped,
                 number(run.result.gradient_norm, 2), number(energy_error, 2), number(position_error, 2),
                 number(1e3 * run.cpu_seconds)});
    }
  }
  report.table(table);
  report.image("networks-accuracy.svg", "Errors of energy and positions against time");
}

}  // namespace supple::bench
