// Accuracy of membranes against time, by tolerance and by the size of triangles, and what their effects cost.
#include <algorithm>
#include <cmath>
#include <utility>

#include "measurement.h"
#include "network_membranes.h"
#include "supple/base/threads.h"
#include "support/shapes.h"

namespace supple::bench {
namespace {

using embedded::Network;
using embedded::RelaxationOptions;
using surface::GeodesicSolver;

void study_membrane_tolerance(const NetworkSettings& settings) {
  Report report(settings.folder, "membranes", "accuracy", "Error against time: the tolerance");
  Table table("membranes-accuracy", {{"step", "Step"},
                                     {"tolerance", "Tolerance"},
                                     {"iterations", "Iterations"},
                                     {"stopped", "Stopped"},
                                     {"gradient", "\\|g\\|"},
                                     {"energy_error", "Error of E"},
                                     {"position_error", "Error of positions / D"},
                                     {"cpu_ms", "CPU ms"}});
  set_thread_count(1);
  const StretchedTorus scene = thesis_torus(settings, true);
  const std::vector<PathStep> path = follow_path(scene, {.gradient = 1e-12});
  const std::vector<int> steps = settings.brief ? std::vector<int>{2} : std::vector<int>{5, 20, 40};
  for (const int number_of_step : steps) {
    const PathStep& step = path[static_cast<std::size_t>(number_of_step - 1)];
    const GeodesicSolver solver(step.mesh);
    Network network = scene.membrane;
    network.points = step.start;
    RelaxationOptions options;
    options.tolerance = 1e-14;
    options.mollifier = Switch::off;
    const embedded::Relaxation reference = embedded::relax(solver, network, options);
    const std::vector<Eigen::Vector3d> end = positions_of(*step.mesh, reference.points);
    for (int digits = 3; digits <= 12; ++digits) {
      options.tolerance = std::pow(10.0, -digits);
      const TimedRun run = fastest_run(settings.brief ? 1 : 7, true, solver, network, options);
      const double off = largest_distance(positions_of(*step.mesh, run.result.points), end);
      table.row({std::to_string(number_of_step), number(options.tolerance, 1), std::to_string(run.result.iterations),
                 std::string(to_string(run.result.stopped)), number(run.result.gradient_norm, 2),
                 number(std::abs(run.result.energy - reference.energy) / reference.energy, 2),
                 number(off / step.mesh->diagonal(), 2), number(1e3 * run.cpu_seconds)});
    }
  }
  report.table(table);
  report.image("membranes-accuracy.svg", "Errors of energy and positions against time");
  report.write(
      "network_bench membrane-accuracy", settings.brief,
      "One load step of the path where one half is stretched, from the equilibrium of the step before, with the "
      "option `tolerance`: converged once \\|g\\| <= tolerance * Young's modulus * thickness * D. Errors are "
      "against a run whose tolerance is 1e-14: of E relative to that run's, of positions the farthest that any "
      "point is off, over D. Times are of the whole call with one thread, the least of several.");
}

void study_membrane_refinement(const NetworkSettings& settings) {
  Report report(settings.folder, "membranes", "refinement", "Error against time: finer triangles");
  Table table("membranes-refinement", {{"radius", "Radius"},
                                       {"points", "Points"},
                                       {"triangles", "Triangles"},
                                       {"energy", "E"},
                                       {"error", "Error of E"},
                                       {"stretch", "Greatest stretch, 99 in 100"},
                                       {"iterations", "Iterations"},
                                       {"not_converged", "Steps not converged"},
                                       {"cpu_ms", "CPU ms"}});
  set_thread_count(1);
  struct Row {
    double radius;
    std::size_t points;
    std::size_t triangles;
    double energy;
    double stretch;
    int iterations;
    int failed;
    double cpu;
  };
  std::vector<Row> rows;
  const std::vector<double> radii =
      settings.brief ? std::vector<double>{0.5, 0.4} : std::vector<double>{0.5, 0.36, 0.25, 0.18, 0.125, 0.09, 0.06};
  for (const double radius : radii) {
    StretchedTorus scene = stretched_torus(settings, true, radius, 1, settings.brief ? 24 : 96);
    scene.steps = 5;
    Row row{radius, scene.membrane.points.size(), scene.membrane.triangles.size(), 0, 0, 0, 0, 0};
    for (int run = 0; run < (settings.brief || radius < 0.2 ? 1 : 3); ++run) {
      const std::vector<PathStep> path = follow_path(scene, {.gradient = 1e-5});
      const PathSummary summary(path);
      row.cpu = run == 0 ? summary.cpu : std::min(row.cpu, summary.cpu);
      row.iterations = summary.all_iterations;
      row.failed = summary.not_converged;
      row.energy = path.back().result.energy;
      std::vector<double> stretches;
      for (const auto& triangle : path.back().result.triangles) stretches.push_back(triangle.stretches[0]);
      row.stretch = quantile(stretches, 0.99);
    }
    rows.push_back(row);
  }
  std::vector<double> lengths, errors;
  const double fine = rows.back().energy;
  for (const Row& row : rows) {
    const bool reference = &row == &rows.back();
    const double error = std::abs(row.energy - fine) / fine;
    if (!reference) {
      lengths.push_back(row.radius);
      errors.push_back(error);
    }
    table.row({number(row.radius, 3), count(static_cast<double>(row.points)), count(static_cast<double>(row.triangles)),
               number(row.energy, 6), reference ? "-" : number(error, 2), number(row.stretch, 4),
               std::to_string(row.iterations), std::to_string(row.failed), number(1e3 * row.cpu)});
  }
  report.table(table);
  report.image("membranes-refinement.svg", "Error of the energy against time for finer triangles");
  report.write(
      "network_bench membrane-accuracy", settings.brief,
      "A torus of 18,432 faces, one half stretched in five steps, with membranes of ever nearer points (*radius*: "
      "their least distance, mesh units; the tube's radius is 0.4) to \\|g\\| < 1e-5. Triangles count as flat, so that "
      "the error is of the shape of the triangles against the surface's curvature. It is relative to the E of the "
      "finest, and falls as radius^" +
          number(fitted_exponent(lengths, errors), 2) +
          " (least squares of the logarithms). Times are of all five steps, the least of several runs, of one for the "
          "finest.");
}

}  // namespace

void study_membrane_accuracy(const NetworkSettings& settings) {
  study_membrane_tolerance(settings);
  study_membrane_refinement(settings);
}

void study_membrane_effects(const NetworkSettings& settings) {
  Report report(settings.folder, "membranes", "effects", "What the effects cost");
  Table table("membranes-effects", {{"strips", "Kept strips"},
                                    {"mollifier", "Mollifier"},
                                    {"steps", "Steps"},
                                    {"iterations", "Iterations"},
                                    {"not_converged", "Steps not converged"},
                                    {"energy", "E of the last step"},
                                    {"searched", "Paths searched, %"},
                                    {"cpu_ms", "CPU ms a load step"},
                                    {"each_ms", "CPU ms an iteration"}});
  set_thread_count(1);
  StretchedTorus scene = thesis_torus(settings, true);
  const auto row = [&](Switch strips, Switch mollifier, double length, int repetitions) {
    std::vector<PathStep> best;
    for (int run = 0; run < repetitions; ++run) {
      std::vector<PathStep> path =
          follow_path(scene, {.mollifier = mollifier, .mollifier_length = length, .kept_strips = strips});
      if (run == 0 || PathSummary(path).cpu < PathSummary(best).cpu) best = std::move(path);
    }
    const PathSummary summary(best);
    double searched = 0, all = 0;
    for (const PathStep& step : best) {
      for (const auto& quantity : step.cost.quantities()) {
        const bool is_path = quantity.name == "same_face" || quantity.name == "unfolded" || quantity.name == "searched";
        if (is_path) all += quantity.value;
        if (quantity.name == "searched") searched += quantity.value;
      }
    }
    table.row({strips == Switch::off ? "off" : "on", mollifier == Switch::on ? number(length, 1) : "off",
               std::to_string(best.size()), std::to_string(summary.all_iterations),
               std::to_string(summary.not_converged), number(best.back().result.energy, 10),
               number(100 * searched / all, 2), number(1e3 * summary.cpu / static_cast<double>(best.size())),
               number(1e3 * summary.cpu / summary.all_iterations)});
  };
  row(Switch::on, Switch::off, 1e-6, settings.brief ? 1 : 5);
  row(Switch::off, Switch::off, 1e-6, settings.brief ? 1 : 5);
  // The mollifier needs each path in full, so that only the first steps are compared with it.
  scene.max_steps = settings.brief ? 1 : 5;
  row(Switch::on, Switch::off, 1e-6, settings.brief ? 1 : 5);
  row(Switch::on, Switch::on, 1e-6, 1);
  row(Switch::on, Switch::on, 1e-3, 1);
  report.table(table);
  report.write(
      "network_bench membrane-effects", settings.brief,
      "The path, or the first steps of it, where one half is stretched, to \\|g\\| < 1e-6, with each effect on and "
      "off. Kept strips never change the answer but for rounding; sides cross several edges, and more of them have to "
      "be searched for than springs between neighbouring faces. CPU time with one thread, the least of several runs.");
}

}  // namespace supple::bench
