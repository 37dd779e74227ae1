// Membranes on a torus that is stretched in steps [Thesis, fig. 3.6]: iterations of a step and their time.
#include "network_membranes.h"

#include <algorithm>
#include <array>
#include <utility>

#include "bill.h"
#include "measurement.h"
#include "supple/base/threads.h"
#include "support/shapes.h"

namespace supple::bench {

using embedded::Relaxation;
using embedded::RelaxationOptions;
using surface::GeodesicSolver;
using surface::SurfacePoint;
using surface::TriangleMesh;

namespace {

constexpr int max_path_iterations = 100;

}  // namespace

std::shared_ptr<const TriangleMesh> StretchedTorus::mesh_at(int step) const {
  const double amount = static_cast<double>(step) / steps;
  std::vector<Eigen::Vector3d> positions = rest->positions();
  for (Eigen::Vector3d& position : positions)
    position[0] += amount * (one_sided ? std::max(0.0, position[0]) : position[0]);
  return testing::share(rest->with_positions(std::move(positions)));
}

StretchedTorus stretched_torus(const NetworkSettings& settings, bool one_sided, double radius, std::uint64_t seed,
                               int around) {
  StretchedTorus scene;
  scene.name = one_sided ? "one half" : "all of it";
  scene.rest = testing::share(testing::torus(around, around / 2));
  scene.one_sided = one_sided;
  if (settings.brief) scene.steps = 4;
  const GeodesicSolver solver(scene.rest);
  scene.membrane.points = embedded::poisson_disk_points(solver, radius, seed);
  const auto triangles = embedded::triangulate(solver, scene.membrane.points).triangles;
  scene.membrane.triangles = embedded::membrane_at_rest(solver, scene.membrane.points, triangles);
  scene.membrane.material = {1, 0.3, 1};
  return scene;
}

StretchedTorus thesis_torus(const NetworkSettings& settings, bool one_sided) {
  return stretched_torus(settings, one_sided, 0.255, 16);
}

std::vector<PathStep> follow_path(const StretchedTorus& scene, const PathOptions& options) {
  std::vector<PathStep> path;
  std::vector<SurfacePoint> last = scene.membrane.points;
  for (int k = 1; k <= std::min(scene.steps, scene.max_steps); ++k) {
    PathStep& step = path.emplace_back();
    const double begun = cpu_seconds();
    step.mesh = scene.mesh_at(k);
    const GeodesicSolver solver(step.mesh);
    step.host_seconds = cpu_seconds() - begun;
    embedded::Network network = scene.membrane;
    network.points = step.start = last;
    RelaxationOptions own;
    own.tolerance = options.gradient / step.mesh->diagonal();
    own.max_iterations = max_path_iterations;
    own.mollifier = options.mollifier;
    own.mollifier_length = options.mollifier_length;
    own.kept_strips = options.kept_strips;
    Execution execution;
    execution.cost = &step.cost;
    const double wall = wall_seconds();
    step.cpu_seconds = cpu_time([&] { step.result = embedded::relax(solver, network, own, execution); });
    step.wall_seconds = wall_seconds() - wall;
    last = step.result.points;
  }
  return path;
}

PathSummary::PathSummary(const std::vector<PathStep>& path) {
  for (const PathStep& step : path) {
    iterations.push_back(step.result.iterations);
    all_iterations += step.result.iterations;
    not_converged += step.result.stopped != embedded::RelaxationTermination::converged;
    cpu += step.cpu_seconds;
    wall += step.wall_seconds;
    host += step.host_seconds;
  }
}

namespace {

void count_iterations(Report& report, const NetworkSettings& settings, const std::array<StretchedTorus, 2>& scenes) {
  report.heading("Iterations of a step");
  report.text(
      "Newton iterations in each of the 50 steps, from the points of the step before, which start with the same "
      "barycentric coordinates. The mollifier is off.");
  Table table("membranes-paths", {{"stretched", "Stretched"},
                                  {"gradient", "\\|g\\| asked for"},
                                  {"mean", "Iterations, mean"},
                                  {"median", "Median"},
                                  {"most", "Most"},
                                  {"not_converged", "Steps not converged"},
                                  {"cpu_ms", "CPU ms a load step"}});
  set_thread_count(1);
  for (const StretchedTorus& scene : scenes) {
    for (const double gradient : {1e-4, thesis_gradient, 1e-9}) {
      double cpu = 0;
      std::vector<PathStep> path;
      for (int run = 0; run < (settings.brief ? 1 : 3); ++run) {
        path = follow_path(scene, {.gradient = gradient});
        const double seconds = PathSummary(path).cpu;
        cpu = run == 0 ? seconds : std::min(cpu, seconds);
      }
      const PathSummary summary(path);
      const double mean_of = static_cast<double>(summary.all_iterations) / scene.steps;
      table.row({scene.name, number(gradient, 1), number(mean_of), number(median(summary.iterations), 2),
                 number(quantile(summary.iterations, 1), 3), std::to_string(summary.not_converged),
                 number(1e3 * cpu / scene.steps)});
      if (gradient == thesis_gradient && scene.one_sided && !settings.brief)
        report.target("Iterations of a step, torus of 2,304 faces, 141 points, one half stretched", "< 5 on average",
                      number(mean_of), mean_of < 5);
    }
  }
  report.table(table);
}

void follow_with_the_host(Report& report, const NetworkSettings& settings,
                          const std::array<StretchedTorus, 2>& scenes) {
  report.heading("With a moving host");
  report.text(
      "The same paths in one call, with the host `moving`: each step starts on the tangent to the path of equilibria, "
      "and one that fails is halved, down to an eighth. The iterations of all attempts count. Where even the shortest "
      "step fails, since the equilibrium is lost at a cut locus, the best state at the next position is taken.");
  Table table("membranes-followed", {{"stretched", "Stretched"},
                                     {"gradient", "\\|g\\| asked for"},
                                     {"mean", "Iterations, mean"},
                                     {"converged_mean", "of steps that are not divided"},
                                     {"median", "Median"},
                                     {"most", "Most"},
                                     {"divided", "Steps divided"},
                                     {"not_converged", "Steps not converged"},
                                     {"energy", "E at the end"},
                                     {"cpu_ms", "CPU ms a load step"}});
  set_thread_count(1);
  for (const StretchedTorus& scene : scenes) {
    const GeodesicSolver solver(scene.rest);
    embedded::MovingHost host;
    for (int step = 1; step <= std::min(scene.steps, scene.max_steps); ++step)
      host.positions.push_back(scene.mesh_at(step)->positions());
    for (const double gradient : {1e-4, thesis_gradient, 1e-9}) {
      RelaxationOptions options;
      options.host = host;
      options.tolerance = gradient / (embedded::largest_weight(scene.membrane) * scene.rest->diagonal());
      options.max_iterations = max_path_iterations;
      Relaxation found;
      double cpu = 0;
      for (int run = 0; run < (settings.brief ? 1 : 3); ++run) {
        const double before = cpu_seconds();
        found = embedded::relax(solver, scene.membrane, options);
        const double seconds = cpu_seconds() - before;
        cpu = run == 0 ? seconds : std::min(cpu, seconds);
      }
      std::vector<double> iterations;
      double all = 0;
      double whole = 0;
      int divided = 0;
      int not_converged = 0;
      for (const embedded::LoadIncrement& stop : found.stops) {
        iterations.push_back(stop.iterations);
        all += stop.iterations;
        not_converged += stop.stopped == embedded::RelaxationTermination::converged ? 0 : 1;
        const bool is_divided = stop.load_steps > 1 || stop.stopped != embedded::RelaxationTermination::converged;
        divided += is_divided ? 1 : 0;
        if (!is_divided) whole += stop.iterations;
      }
      const auto steps = static_cast<double>(found.stops.size());
      table.row({scene.name, number(gradient, 1), number(all / steps), number(whole / (steps - divided)),
                 number(median(iterations), 2), number(quantile(iterations, 1), 3), std::to_string(divided),
                 std::to_string(not_converged), number(found.energy, 8), number(1e3 * cpu / steps)});
    }
  }
  report.table(table);
}

void measure_time(Report& report, const NetworkSettings& settings, const StretchedTorus& scene) {
  report.heading("Time of an iteration");
  report.text(
      "The path where one half is stretched, to \\|g\\| < 1e-6: all times over all iterations, with the line searches "
      "and the motion of the points. Steps that do not converge are left out. *Host* is what a load step costs "
      "besides: "
      "the mesh's new shape and its solver. Shares are of the bill's stages, of which *other* is the line search's "
      "own, "
      "the description of the end, and points that settle by themselves. The thesis gives 97 ms for an iteration of a "
      "torus membrane of 282 unknowns. The least of several runs, of CPU time with one thread and of wall time with "
      "two.");
  Table table("membranes-time", {{"threads", "Threads"},
                                 {"steps", "Load steps"},
                                 {"iterations", "Iterations"},
                                 {"ms", "ms an iteration"},
                                 {"load_ms", "ms a load step"},
                                 {"host_ms", "Host, CPU ms a load step"},
                                 {"search", "Search %"},
                                 {"assembly", "Assembly %"},
                                 {"step", "Factorization %"},
                                 {"motion", "Motion %"},
                                 {"other", "Other %"}});
  double fastest = 0;
  for (const int threads : {1, 2}) {
    set_thread_count(threads);
    double best = 0;
    double host = 0;
    std::size_t steps = 0;
    std::array<double, 5> parts{};
    int all = 0;
    for (int run = 0; run < (settings.brief ? 1 : 7); ++run) {
      std::vector<PathStep> path = follow_path(scene, {});
      std::erase_if(
          path, [](const PathStep& step) { return step.result.stopped != embedded::RelaxationTermination::converged; });
      const PathSummary summary(path);
      const double seconds = threads == 1 ? summary.cpu : summary.wall;
      if (run > 0 && seconds >= best) continue;
      best = seconds;
      host = summary.host;
      steps = path.size();
      all = summary.all_iterations;
      parts = {};
      const char* const stages[] = {"search", "assembly", "step", "motion"};
      for (const PathStep& step : path)
        for (std::size_t k = 0; k < 4; ++k) parts[k] += stage_seconds(step.cost, stages[k]);
      parts[4] = std::max(0.0, summary.wall - parts[0] - parts[1] - parts[2] - parts[3]);
    }
    double sum = 0;
    for (const double part : parts) sum += part;
    const double ms = 1e3 * best / all;
    fastest = threads == 1 ? ms : std::min(fastest, ms);
    const auto share = [&](std::size_t k) { return number(100 * parts[k] / sum, 2); };
    const double load_ms = 1e3 / static_cast<double>(steps);
    table.row({std::to_string(threads), std::to_string(steps), std::to_string(all), number(ms), number(load_ms * best),
               number(load_ms * host), share(0), share(1), share(2), share(3), share(4)});
  }
  if (!settings.brief)
    report.target("An iteration of the membrane of 141 points", "< 3 ms on two cores", number(fastest) + " ms",
                  fastest < 3);
  report.table(table);
}

}  // namespace

void study_membrane_paths(const NetworkSettings& settings) {
  Report report(settings.folder, "membranes", "paths", "Iterations and their time");
  const std::array<StretchedTorus, 2> scenes{thesis_torus(settings, true), thesis_torus(settings, false)};
  measure_time(report, settings, scenes[0]);
  count_iterations(report, settings, scenes);
  follow_with_the_host(report, settings, scenes);
  report.write("network_bench membrane-paths", settings.brief,
               "A membrane on a torus that is stretched to twice its length in 50 steps.");
}

}  // namespace supple::bench
