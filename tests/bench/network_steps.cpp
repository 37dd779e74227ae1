// What one Newton step of a network costs, and how that grows.
#include <algorithm>
#include <cmath>
#include <limits>

#include "measurement.h"
#include "network_bench.h"
#include "supple/base/random.h"
#include "supple/base/threads.h"
#include "supple/surface/retraction.h"
#include "support/shapes.h"

namespace supple::bench {
namespace {

using embedded::Network;
using surface::GeodesicSolver;
using surface::PointPair;
using surface::SurfacePoint;
using surface::TriangleMesh;

/// Distance by which points move while their strips stay valid, in mean edges.
constexpr double small_distance = 0.01;
constexpr double search_limit_ms = 6;
constexpr double unfolding_limit_ms = 2;

/// One random point in each face, and springs as in the scenes.
Scene spread_scene(std::string name, TriangleMesh mesh) {
  Scene scene = face_scene(std::move(name), std::move(mesh), Eigen::Vector3d::Constant(1.0 / 3));
  RandomStream random("network_bench", 1);
  for (SurfacePoint& point : scene.network.points) {
    const double a = std::sqrt(random.uniform());
    const double b = random.uniform();
    point.barycentric = Eigen::Vector3d(1 - a, a * (1 - b), a * b);
  }
  return scene;
}

std::vector<PointPair> pairs_of(const embedded::Network& network, const std::vector<SurfacePoint>& points) {
  std::vector<PointPair> pairs;
  for (const embedded::Spring& spring : network.springs)
    pairs.push_back({points[static_cast<std::size_t>(spring.from)], points[static_cast<std::size_t>(spring.to)]});
  return pairs;
}

std::vector<SurfacePoint> moved_a_little(const TriangleMesh& mesh, const std::vector<SurfacePoint>& points) {
  RandomStream random("network_bench", 2);
  std::vector<SurfacePoint> moved;
  for (const SurfacePoint& point : points) {
    const double angle = 2 * M_PI * random.uniform();
    const double distance = small_distance * mesh.mean_edge_length();
    moved.push_back(
        surface::retract(mesh, point, distance * Eigen::Vector2d(std::cos(angle), std::sin(angle)), {}).end);
  }
  return moved;
}

struct Times {
  double cpu_ms = 0;   ///< one thread
  double wall_ms = 0;  ///< two threads
  double least_ms() const { return std::min(cpu_ms, wall_ms); }
};

/// The least times of several runs.
template <typename Action>
Times times_of(int repetitions, Action&& action) {
  std::vector<double> cpu, wall;
  for (const int threads : {1, 2}) {
    set_thread_count(threads);
    action();
    for (int i = 0; i < repetitions; ++i) {
      const double start = wall_seconds();
      const double taken = cpu_time(action);
      if (threads == 1)
        cpu.push_back(1e3 * taken);
      else
        wall.push_back(1e3 * (wall_seconds() - start));
    }
  }
  return {least(cpu), least(wall)};
}

std::string both(const Times& times) {
  return number(times.wall_ms) + " ms wall on two threads, " + number(times.cpu_ms) + " ms CPU on one";
}

void measure_springs_of(Report& report, const NetworkSettings& settings, Table& table, const Scene& scene) {
  const GeodesicSolver solver(scene.mesh);
  const std::vector<PointPair> here = pairs_of(scene.network, scene.network.points);
  const std::vector<PointPair> there = pairs_of(scene.network, moved_a_little(*scene.mesh, scene.network.points));
  const int repetitions = settings.brief ? 3 : 40;
  const auto row = [&](const char* what, const Times& times, const surface::PathCounts* found) {
    const auto cell = [&](std::int64_t n) { return found ? count(static_cast<double>(n)) : std::string("-"); };
    table.row({scene.name, count(scene.mesh->face_count()), count(static_cast<double>(here.size())), what,
               cell(found ? found->same_face : 0), cell(found ? found->unfolded : 0), cell(found ? found->searched : 0),
               number(times.cpu_ms), number(times.wall_ms)});
  };
  std::vector<surface::Geodesic> geodesics(here.size());
  const Times whole = times_of(repetitions, [&] { solver.pairs(here, geodesics, {.derivatives = 2}); });
  row("`pairs` with Hessians", whole, nullptr);

  std::vector<surface::TangentGeodesic> found(here.size());
  surface::PathCounts how;
  // At the start of the scenes some springs go round vertices, so that their paths must be searched.
  const Network hard = face_scene("", TriangleMesh(*scene.mesh), near_vertex).network;
  const std::vector<PointPair> hard_pairs = pairs_of(hard, hard.points);
  const Times at_vertices = times_of(repetitions, [&] { how = solver.tangent_geodesics(hard_pairs, found, false); });
  row("`tangent_geodesics`, nothing known, points near vertices", at_vertices, &how);
  const Times searched = times_of(repetitions, [&] { how = solver.tangent_geodesics(here, found, false); });
  row("`tangent_geodesics`, nothing known", searched, &how);

  bool at_home = true;
  const Times unfolded = times_of(repetitions, [&] {
    how = solver.tangent_geodesics(at_home ? there : here, found, true);
    at_home = !at_home;
  });
  row("`tangent_geodesics`, strips known", unfolded, &how);
  if (settings.brief || here.size() < 6000) return;
  const std::string springs = count(static_cast<double>(here.size())) + " springs with Hessians, " + scene.name;
  report.target(springs + ", nothing known", "< 6 ms on two cores", both(searched),
                searched.least_ms() < search_limit_ms);
  report.target(springs + ", nothing known, points near vertices", "< 6 ms on two cores", both(at_vertices),
                at_vertices.least_ms() < search_limit_ms);
  report.target(springs + ", strips known", "< 2 ms on two cores", both(unfolded),
                unfolded.least_ms() < unfolding_limit_ms);
}

/// Mean seconds of a step in a run, and its wall seconds by stage.
struct StepTime {
  double total = std::numeric_limits<double>::infinity();
  double wall = total;
  double search = total;
  double assembly = total;
  double solve = total;
  double motion = total;
  int steps = 0;

  /// Keeps the least time of each stage: other programs seldom disturb the same stage in all runs.
  void take(const TimedRun& run, bool cpu) {
    const TimedStep& end = run.steps.back();
    steps = static_cast<int>(run.steps.size()) - 1;
    const double n = std::max(1, steps);
    total = std::min(total, (cpu ? end.cpu_seconds : end.wall_seconds) / n);
    wall = std::min(wall, end.wall_seconds / n);
    search = std::min(search, end.search / n);
    assembly = std::min(assembly, end.assembly / n);
    solve = std::min(solve, end.solve / n);
    motion = std::min(motion, end.motion / n);
  }
};

struct MeasuredScene {
  Times times;
  int steps = 0;
};

MeasuredScene measure_scene(const NetworkSettings& settings, Table& table, const Scene& scene, int repetitions) {
  const GeodesicSolver solver(scene.mesh);
  embedded::RelaxationOptions options;
  options.tolerance = scene.tolerance_for(1e-6);
  options.max_iterations = settings.brief ? 3 : 30;
  MeasuredScene measured;
  for (const int threads : {1, 2}) {
    set_thread_count(threads);
    StepTime time;
    for (int i = 0; i < repetitions; ++i) time.take(timed_run(solver, scene.network, options), threads == 1);
    const double ms = 1e3 * time.total;
    measured.steps = time.steps;
    (threads == 1 ? measured.times.cpu_ms : measured.times.wall_ms) = ms;
    const double parts = time.search + time.assembly + time.solve + time.motion;
    const double other = std::max(0.0, time.wall - parts);
    const double all = parts + other;
    const auto share = [&](double seconds) { return number(100 * seconds / all, 2); };
    table.row({scene.name, count(scene.mesh->face_count()), count(static_cast<double>(scene.network.springs.size())),
               count(scene.unknowns()), std::to_string(threads), std::to_string(time.steps), number(ms),
               share(time.search), share(time.assembly), share(time.solve), share(time.motion), share(other)});
  }
  return measured;
}

}  // namespace

void study_network_steps(const NetworkSettings& settings) {
  Report report(settings.folder, "networks", "steps", "Time of a Newton step");
  report.heading("Springs of one state");
  report.text(
      "Lengths, gradients and Hessians of all springs: one random point in each face, two springs to each neighbour. "
      "*Strips known*: all points have moved by " +
      number(small_distance, 1) +
      " h since the state before, whose crossed faces are unfolded first. *In a face*, *unfolded* and *searched* count "
      "the springs by how their path was found: between neighbouring faces no search is needed where the straight way "
      "through their edge cannot be undercut.");
  Table springs("networks-springs", {{"mesh", "Mesh"},
                                     {"faces", "Faces"},
                                     {"springs", "Springs"},
                                     {"how", "How"},
                                     {"same_face", "In a face"},
                                     {"unfolded", "Unfolded"},
                                     {"searched", "Searched"},
                                     {"cpu_ms", "CPU ms, one thread"},
                                     {"wall_ms", "Wall ms, two threads"}});
  if (settings.brief) {
    measure_springs_of(report, settings, springs, spread_scene("torus", testing::torus(24, 12)));
  } else {
    measure_springs_of(report, settings, springs, spread_scene("torus", testing::torus(50, 20)));
    measure_springs_of(report, settings, springs, spread_scene("three holes", testing::genus3(4)));
    measure_springs_of(report, settings, springs, spread_scene("knot", testing::trefoil_knot(80, 12)));
  }
  report.table(springs);

  report.heading("One Newton step");
  report.text(
      "The mean step of a run to |g| < 1e-6 (at most 30 steps) with all that belongs to it: the springs' geodesics and "
      "their Hessians at every trial of the line search, assembly, factorization and solution, and the motion of the "
      "points across faces. Shares are in percent of wall time; *other* is the line search's own and points "
      "that settle by themselves. The thesis gives 172 ms for a step of the torus with 1,152 unknowns and 1,218 ms for "
      "one with 4,000 on 64 cores; with one thread the table's *ms* are CPU, with two they are wall time.");
  const std::vector<Table::Column> columns = {
      {"scene", "Scene"},         {"faces", "Faces"},   {"springs", "Springs"}, {"unknowns", "Unknowns"},
      {"threads", "Threads"},     {"steps", "Steps"},   {"ms", "ms per step"},  {"search", "Geodesics %"},
      {"assembly", "Assembly %"}, {"solve", "Solve %"}, {"motion", "Motion %"}, {"other", "Other %"}};
  Table steps("networks-steps", columns);
  const int repetitions = settings.brief ? 1 : 9;
  std::vector<Scene> scenes = face_scenes(settings);
  for (const Scene& scene : scenes) {
    const MeasuredScene measured = measure_scene(settings, steps, scene, repetitions);
    if (settings.brief || scene.name.ends_with("on edges")) continue;
    const double limit = scene.mesh->face_count() < 1000 ? 5 : 20;
    report.target("A Newton step of " + count(scene.unknowns()) + " unknowns: " + scene.name,
                  "< " + number(limit, 1) + " ms on two cores", both(measured.times),
                  measured.times.least_ms() < limit);
  }
  report.table(steps);

  report.heading("Growth");
  Table growth("networks-growth", columns);
  std::vector<double> unknowns, cpu, wall;
  const std::vector<std::pair<int, int>> sizes =
      settings.brief ? std::vector<std::pair<int, int>>{{16, 8}, {24, 12}}
                     : std::vector<std::pair<int, int>>{{24, 12}, {48, 24}, {80, 40}, {112, 56}, {158, 79}, {224, 112}};
  for (const auto& [around, across] : sizes) {
    const Scene scene = face_scene("torus", testing::torus(around, across), near_vertex);
    const bool large = scene.unknowns() > 10'000;
    const MeasuredScene measured = measure_scene(settings, growth, scene, settings.brief ? 1 : large ? 3 : 7);
    unknowns.push_back(scene.unknowns());
    cpu.push_back(measured.times.cpu_ms);
    wall.push_back(measured.times.wall_ms);
  }
  const double exponent = fitted_exponent(unknowns, cpu);
  report.text(
      "The torus with one point in each face, near vertices, of growing size. CPU time of a step grows as "
      "unknowns^" +
      number(exponent, 3) + ", wall time on two threads as unknowns^" + number(fitted_exponent(unknowns, wall), 3) +
      " (least squares of the logarithms).");
  report.table(growth);
  report.image("networks-growth.svg", "Time of a step against the number of unknowns");
  report.write("network_bench steps", settings.brief,
               "Springs, Newton steps and how their time grows with the number of unknowns.");
}

}  // namespace supple::bench
