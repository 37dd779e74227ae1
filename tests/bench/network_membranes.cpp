// Membranes on a torus that is stretched in steps (thesis fig. 3.6): iterations, their time, and the figure.
#include "network_membranes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "bill.h"
#include "measurement.h"
#include "supple/base/threads.h"
#include "supple/surface/retraction.h"
#include "support/shapes.h"

namespace supple::bench {

using embedded::Relaxation;
using embedded::RelaxationOptions;
using surface::GeodesicSolver;
using surface::SurfacePoint;
using surface::TriangleMesh;

namespace {

/// An iteration after which this share of |g| is left was short of its aim.
constexpr double slow_contraction = 0.5;
constexpr double longest_extension = 16;

/// The points, each moved by `times` the way to it.
std::vector<SurfacePoint> extended(const GeodesicSolver& solver, const std::vector<SurfacePoint>& from,
                                   const std::vector<SurfacePoint>& to, double times) {
  std::vector<surface::PointPair> pairs;
  for (std::size_t i = 0; i < to.size(); ++i) pairs.push_back({from[i], to[i]});
  std::vector<surface::TangentGeodesic> ways(pairs.size());
  solver.tangent_geodesics(pairs, ways, false);
  std::vector<SurfacePoint> points = to;
  for (std::size_t i = 0; i < to.size(); ++i)
    if (ways[i].distance > 0 && std::isfinite(ways[i].distance) && !surface::on_cone_tip(solver.mesh(), to[i]))
      points[i] = surface::retract(solver.mesh(), to[i], times * ways[i].distance * ways[i].to_direction, {}).end;
  return points;
}

RelaxationOptions relaxation_options(const PathOptions& options, double diagonal) {
  RelaxationOptions own;
  own.tolerance = options.gradient / diagonal;
  own.max_iterations = options.max_iterations;
  own.mollifier = options.mollifier;
  own.mollifier_length = options.mollifier_length;
  own.kept_strips = options.kept_strips;
  return own;
}

/// Newton's method one iteration at a time, and longer steps where it is slow.
void relax_with_longer_steps(const GeodesicSolver& solver, embedded::Network network, const PathOptions& options,
                             PathStep& step) {
  RelaxationOptions one = relaxation_options(options, solver.mesh().diagonal());
  one.max_iterations = 1;
  one.mollifier = Switch::off;
  RelaxationOptions none = one;
  none.max_iterations = 0;
  int iterations = 0;
  while (iterations < options.max_iterations) {
    Relaxation next = embedded::relax(solver, network, one);
    const std::vector<SurfacePoint> before = std::exchange(network.points, next.points);
    if (next.iterations > 0) ++iterations;
    step.result = std::move(next);
    if (step.result.stopped != "iteration_limit") break;
    const auto& history = step.result.history;
    if (history.back().gradient_norm < slow_contraction * history.front().gradient_norm) continue;
    const std::vector<SurfacePoint> newton = network.points;
    double energy = step.result.energy;
    for (double times = 1; times <= longest_extension; times *= 2) {
      embedded::Network farther = network;
      farther.points = extended(solver, before, newton, times);
      ++step.trials;
      Relaxation there = embedded::relax(solver, farther, none);
      if (!(there.energy < energy)) break;
      energy = there.energy;
      network.points = there.points;
      step.result = std::move(there);
    }
  }
  step.result.iterations = iterations;
}

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
  const embedded::Triangulation dual = embedded::triangulate(solver, scene.membrane.points);
  scene.membrane.triangles = embedded::membrane_at_rest(solver, scene.membrane.points, dual.triangles);
  scene.membrane.material = {1, 0.3, 1};
  scene.sides = dual.edges;
  return scene;
}

StretchedTorus thesis_torus(const NetworkSettings& settings, bool one_sided) {
  return stretched_torus(settings, one_sided, 0.255, 16);
}

std::vector<PathStep> follow_path(const StretchedTorus& scene, const PathOptions& options) {
  std::vector<PathStep> path;
  std::vector<SurfacePoint> before = scene.membrane.points;
  std::vector<SurfacePoint> last = before;
  for (int k = 1; k <= std::min(scene.steps, scene.followed); ++k) {
    PathStep& step = path.emplace_back();
    const double begun = cpu_seconds();
    step.mesh = scene.mesh_at(k);
    const GeodesicSolver solver(step.mesh);
    step.host_seconds = cpu_seconds() - begun;
    embedded::Network network = scene.membrane;
    const double cpu = cpu_seconds();
    const double wall = wall_seconds();
    step.start = options.start == PathStart::continued && k > 2 ? extended(solver, before, last, 1) : last;
    network.points = step.start;
    if (options.longer_steps) {
      relax_with_longer_steps(solver, std::move(network), options, step);
    } else {
      Execution execution;
      execution.cost = &step.cost;
      step.result = embedded::relax(solver, network, relaxation_options(options, step.mesh->diagonal()), execution);
    }
    step.cpu_seconds = cpu_seconds() - cpu;
    step.wall_seconds = wall_seconds() - wall;
    before = std::exchange(last, step.result.points);
  }
  return path;
}

std::vector<double> distortions(const std::vector<embedded::TriangleState>& triangles) {
  std::vector<double> values;
  for (const embedded::TriangleState& triangle : triangles)
    values.push_back(std::max(triangle.stretches[0], 1 / triangle.stretches[1]) - 1);
  return values;
}

namespace {

struct PathSummary {
  std::vector<double> iterations;
  int all = 0;
  int not_converged = 0;
  int trials = 0;
  double cpu = 0;
  double wall = 0;
  double host = 0;

  explicit PathSummary(const std::vector<PathStep>& path) {
    for (const PathStep& step : path) {
      iterations.push_back(step.result.iterations);
      all += step.result.iterations;
      not_converged += step.result.stopped != "converged";
      trials += step.trials;
      cpu += step.cpu_seconds;
      wall += step.wall_seconds;
      host += step.host_seconds;
    }
  }
};

const char* start_words(PathStart start) { return start == PathStart::kept ? "kept" : "continued"; }

struct Way {
  const char* name;
  PathOptions options;
};

void compare_ways(Report& report, const NetworkSettings& settings, const std::array<StretchedTorus, 2>& scenes) {
  report.heading("Iterations");
  report.text(
      "Newton iterations in each of the 50 steps, from the points of the step before. *Kept*: they start with the same "
      "barycentric coordinates, *continued*: as far beyond these as they went in the step before, along the surface. "
      "*Longer steps* is an attempt in this program: after an iteration by which \\|g\\| fell to no less than half, "
      "the points go as far again along the same directions as long as E falls (*trials* counts these energies; such a "
      "path has no time here, because each iteration begins anew). The mollifier is off here: what its search costs "
      "where a step ends at a cut locus is below.");
  Table table("membranes-paths", {{"stretched", "Stretched"},
                                  {"gradient", "\\|g\\| asked for"},
                                  {"start", "Start"},
                                  {"longer", "Longer steps"},
                                  {"mean", "Iterations, mean"},
                                  {"median", "Median"},
                                  {"most", "Most"},
                                  {"trials", "Trials"},
                                  {"not_converged", "Steps not converged"},
                                  {"cpu_ms", "CPU ms a load step"}});
  Table steps("membranes-steps", {{"stretched", "Stretched"},
                                  {"gradient", "|g|"},
                                  {"start", "Start"},
                                  {"longer", "Longer steps"},
                                  {"step", "Step"},
                                  {"iterations", "Iterations"},
                                  {"stopped", "Stopped"}});
  std::vector<PathOptions> ways;
  for (const double gradient : {1e-4, thesis_gradient, 1e-9}) ways.push_back({.gradient = gradient});
  ways.push_back({.start = PathStart::continued});
  ways.push_back({.longer_steps = true});
  set_thread_count(1);
  for (const StretchedTorus& scene : scenes) {
    for (PathOptions way : ways) {
      way.mollifier = Switch::off;
      double cpu = 0;
      std::vector<PathStep> path;
      for (int run = 0; run < (settings.brief || way.longer_steps ? 1 : 3); ++run) {
        path = follow_path(scene, way);
        const double seconds = PathSummary(path).cpu;
        cpu = run == 0 ? seconds : std::min(cpu, seconds);
      }
      const PathSummary summary(path);
      table.row({scene.name, number(way.gradient, 1), start_words(way.start), way.longer_steps ? "yes" : "no",
                 number(static_cast<double>(summary.all) / scene.steps), number(median(summary.iterations), 2),
                 number(quantile(summary.iterations, 1), 3), std::to_string(summary.trials),
                 std::to_string(summary.not_converged), way.longer_steps ? "-" : number(1e3 * cpu / scene.steps)});
      for (std::size_t k = 0; k < path.size(); ++k)
        steps.row({scene.name, number(way.gradient, 1), start_words(way.start), way.longer_steps ? "yes" : "no",
                   std::to_string(k + 1), std::to_string(path[k].result.iterations), path[k].result.stopped});
      const bool plain = way.start == PathStart::kept && !way.longer_steps && way.gradient == thesis_gradient;
      if (plain && scene.one_sided && !settings.brief) {
        const double mean_of = static_cast<double>(summary.all) / scene.steps;
        report.target("Iterations of a step, torus of 2,304 faces, 141 points, one half stretched", "< 5 on average",
                      number(mean_of), mean_of < 5);
      }
    }
  }
  report.table(table);
  report.data(steps);
  report.image("membranes-steps.svg", "Iterations of the steps");
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
    for (int step = 1; step <= std::min(scene.steps, scene.followed); ++step)
      host.positions.push_back(scene.mesh_at(step)->positions());
    for (const double gradient : {1e-4, thesis_gradient, 1e-9}) {
      RelaxationOptions options;
      options.host = host;
      options.tolerance = gradient / (embedded::largest_weight(scene.membrane) * scene.rest->diagonal());
      options.max_iterations = 100;
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
      for (const embedded::FollowedStop& stop : found.stops) {
        iterations.push_back(stop.iterations);
        all += stop.iterations;
        not_converged += stop.stopped == "converged" ? 0 : 1;
        const bool is_divided = stop.load_steps > 1 || stop.stopped != "converged";
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
      "and the motion of the points. Steps that end at a cut locus are left out; they are below. *Host* is what a load "
      "step costs besides: the mesh's new shape and its solver. Shares are of the bill's stages, of which *other* is "
      "the line search's own, the description of the end, and points that settle by themselves. The thesis gives 97 ms "
      "for an iteration of a torus membrane of 282 unknowns. The least of several runs, of CPU time with one thread "
      "and of wall time with two.");
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
      std::vector<PathStep> path = follow_path(scene, {.mollifier = Switch::off});
      std::erase_if(path, [](const PathStep& step) { return step.result.stopped != "converged"; });
      const PathSummary summary(path);
      const double seconds = threads == 1 ? summary.cpu : summary.wall;
      if (run > 0 && seconds >= best) continue;
      best = seconds;
      host = summary.host;
      steps = path.size();
      all = summary.all;
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
    report.target("An iteration of the membrane of 141 points, without steps that end at a cut locus",
                  "< 3 ms on two cores", number(fastest) + " ms", fastest < 3);
  report.table(table);
}

void measure_cut_loci(Report& report, const NetworkSettings& settings, const std::array<StretchedTorus, 2>& scenes) {
  report.heading("Steps that end at a cut locus");
  report.text(
      "A side that pushes is driven to where two shortest paths are equally long: its energy has a valley there, with "
      "a kink at the bottom, behind one of the torus's outer vertices. Its ends are put on the bottom and kept there, "
      "held by both paths. *At a cut locus* counts the steps that end so, converged or not. With the mollifier on "
      "automatic a second search, of mollified lengths, follows where the first does not converge. Paths to "
      "\\|g\\| < 1e-9, CPU time with one thread, least of several runs.");
  Table table("membranes-cut-loci", {{"stretched", "Stretched"},
                                     {"mollifier", "Mollifier"},
                                     {"cut_locus", "Steps at a cut locus"},
                                     {"other", "Steps not converged"},
                                     {"cpu_ms", "CPU ms a load step"},
                                     {"converged_ms", "of those that converge"},
                                     {"failed_ms", "of the others"},
                                     {"energy", "E of the last step"}});
  set_thread_count(1);
  for (const StretchedTorus& scene : scenes)
    for (const Switch mollifier : {Switch::off, Switch::automatic}) {
      std::vector<PathStep> best;
      for (int run = 0; run < (settings.brief ? 1 : 2); ++run) {
        std::vector<PathStep> path = follow_path(scene, {.gradient = 1e-9, .mollifier = mollifier});
        if (best.empty() || PathSummary(path).cpu < PathSummary(best).cpu) best = std::move(path);
      }
      int cut = 0, other = 0;
      std::vector<double> good, bad;
      for (const PathStep& step : best) {
        const bool converged = step.result.stopped == "converged";
        cut += std::ranges::any_of(step.result.triangles, &embedded::TriangleState::at_cut_locus);
        other += !converged;
        (converged ? good : bad).push_back(1e3 * step.cpu_seconds);
      }
      const auto cell = [](const std::vector<double>& values) {
        return values.empty() ? std::string("-") : number(mean(values));
      };
      table.row({scene.name, mollifier == Switch::off ? "off" : "automatic", std::to_string(cut), std::to_string(other),
                 number(1e3 * PathSummary(best).cpu / scene.steps), cell(good), cell(bad),
                 number(best.back().result.energy, 8)});
    }
  report.table(table);
}

/// Corners and distortion of every triangle at the last step, as it is and as if the coordinates were kept.
void draw_figure(Report& report, const StretchedTorus& scene) {
  report.heading("The figure");
  const std::vector<PathStep> path = follow_path(scene, {.mollifier = Switch::off});
  Table triangles("membranes-figure", {{"step", "Step"},
                                       {"how", "How"},
                                       {"distortion", "Distortion"},
                                       {"x0", "x0"},
                                       {"y0", "y0"},
                                       {"z0", "z0"},
                                       {"x1", "x1"},
                                       {"y1", "y1"},
                                       {"z1", "z1"},
                                       {"x2", "x2"},
                                       {"y2", "y2"},
                                       {"z2", "z2"}});
  Table summary("membranes-distortion", {{"step", "Step"},
                                         {"how", "Coordinates"},
                                         {"energy", "E"},
                                         {"median", "Distortion, median"},
                                         {"high", "of 1 in 10"},
                                         {"most", "most"}});
  for (const int step : {scene.steps / 2, scene.steps}) {
    const PathStep& end = path[static_cast<std::size_t>(step - 1)];
    const GeodesicSolver solver(end.mesh);
    RelaxationOptions none;
    none.max_iterations = 0;
    none.mollifier = Switch::off;
    const Relaxation kept = embedded::relax(solver, scene.membrane, none);
    for (const auto& [how, state] :
         {std::pair<const char*, const Relaxation&>{"kept", kept}, {"optimized", end.result}}) {
      const std::vector<double> values = distortions(state.triangles);
      const std::vector<Eigen::Vector3d> places = positions_of(*end.mesh, state.points);
      summary.row({std::to_string(step), how, number(state.energy, 4), number(median(values)),
                   number(quantile(values, 0.9)), number(quantile(values, 1))});
      for (std::size_t t = 0; t < values.size(); ++t) {
        std::vector<std::string> cells{std::to_string(step), how, number(values[t], 4)};
        for (const std::int32_t corner : scene.membrane.triangles[t].corners)
          for (int axis = 0; axis < 3; ++axis)
            cells.push_back(number(places[static_cast<std::size_t>(corner)][axis], 5));
        triangles.row(std::move(cells));
      }
    }
  }
  report.text(
      "Thesis fig. 3.6: a membrane on a torus of which one half is stretched to twice its length, with its barycentric "
      "coordinates kept and with those of least energy. Distortion of a triangle is how far the greater principal "
      "stretch, or the inverse of the lesser, is from 1.");
  report.table(summary);
  report.data(triangles);
  report.image("membranes-figure.svg", "Distortion with kept and with optimized coordinates");
}

}  // namespace

void measure_stretched_torus(Report& report, const NetworkSettings& settings) {
  const std::array<StretchedTorus, 2> scenes{thesis_torus(settings, true), thesis_torus(settings, false)};
  compare_ways(report, settings, scenes);
  follow_with_the_host(report, settings, scenes);
  measure_time(report, settings, scenes[0]);
  measure_cut_loci(report, settings, scenes);
  draw_figure(report, scenes[0]);
}

}  // namespace supple::bench
