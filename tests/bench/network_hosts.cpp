// Networks on shells and solids: convergence of the thesis's scenes with two-way coupling, and what a step costs.
#include "network_hosts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "measurement.h"
#include "supple/base/threads.h"
#include "supple/embedded/network_builders.h"
#include "support/nearest_point.h"
#include "support/shapes.h"

namespace supple::bench {

using embedded::Network;
using embedded::Relaxation;
using embedded::RelaxationOptions;
using surface::GeodesicSolver;
using surface::TriangleMesh;

const double sphere_radius = 0.5 / std::sqrt(3.0);

RelaxationOptions HostScene::options(double gradient) const {
  RelaxationOptions options;
  options.host = host;
  options.tolerance = scene.tolerance_for(gradient);
  options.max_iterations = 1000;
  return options;
}

TriangleMesh sphere(int subdivisions) {
  const TriangleMesh unit = testing::icosphere(subdivisions);
  std::vector<Eigen::Vector3d> positions = unit.positions();
  for (Eigen::Vector3d& p : positions) p *= sphere_radius;
  return unit.with_positions(std::move(positions));
}

embedded::ShellHost thesis_shell(double volume_scale) {
  return {.thickness = 0.003,
          .youngs_modulus = 1e4,
          .poisson_ratio = 0.48,
          .volume_weight = 1e3,
          .volume_scale = volume_scale,
          .fixed_vertices = {0}};
}

namespace {

constexpr double tight_host_gradient = 1e-10;
constexpr double shell_limit_ms = 12;
constexpr double solid_limit_ms = 300;

/// Adds springs between neighbours, and fixes some points.
void join(Scene& scene, double rest_fraction, double weight, std::size_t fixed_every) {
  const GeodesicSolver solver(scene.mesh);
  Network& network = scene.network;
  const auto edges = embedded::triangulate(solver, network.points).edges;
  for (const auto& [a, b] : edges) {
    const double length =
        solver.distance(network.points[static_cast<std::size_t>(a)], network.points[static_cast<std::size_t>(b)]);
    network.springs.push_back({a, b, rest_fraction * length, weight / static_cast<double>(edges.size())});
  }
  const std::size_t stride = fixed_every > 0 ? fixed_every : network.points.size();
  for (std::size_t i = 0; i < network.points.size(); i += stride)
    network.fixed_points.push_back(static_cast<std::int32_t>(i));
}

}  // namespace

std::vector<Eigen::Vector3d> points_on_sphere(double distance) {
  const GeodesicSolver solver(testing::share(sphere(3)));
  return positions_of(solver.mesh(), embedded::poisson_disk_points(solver, distance));
}

HostScene shell_scene(const std::string& name, TriangleMesh mesh, const std::vector<Eigen::Vector3d>& points,
                      double rest_fraction, double weight, std::size_t fixed_every, double volume_scale) {
  HostScene made{{name, testing::share(std::move(mesh)), {}}, thesis_shell(volume_scale)};
  for (const Eigen::Vector3d& p : points)
    made.scene.network.points.push_back(testing::nearest_point(*made.scene.mesh, p));
  join(made.scene, rest_fraction, weight, fixed_every);
  return made;
}

HostScene rabbit_scene(int n, double spacing, double element_size) {
  const TriangleMesh built = testing::rabbit(n);
  std::vector<Eigen::Vector3d> positions = built.positions();
  for (Eigen::Vector3d& p : positions) p /= built.diagonal();
  HostScene made{{"rabbit", testing::share(built.with_positions(std::move(positions))), {}}, {}};
  const TriangleMesh& mesh = *made.scene.mesh;
  made.scene.network.points = embedded::poisson_disk_points(GeodesicSolver(made.scene.mesh), spacing);
  join(made.scene, 0, 10, 6);
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Eigen::Vector3d& p : mesh.positions()) {
    low = std::min(low, p.z());
    high = std::max(high, p.z());
  }
  embedded::SolidHost solid;
  solid.youngs_modulus = 10;
  solid.poisson_ratio = 0.49;
  solid.element_size = element_size * mesh.mean_edge_length();
  const double top = high - 0.15 * (high - low);
  solid.regions = {{{-1, -1, top}, {1, 1, 1}, 1e3}};
  for (std::int32_t i = 0; i < mesh.vertex_count(); ++i)
    if (mesh.positions()[i].z() < low + 0.1 * (high - low)) solid.fixed_vertices.push_back(i);
  made.host = std::move(solid);
  return made;
}

double unknowns_of(const HostScene& scene, const Relaxation& relaxed) {
  const auto nodes = static_cast<double>(relaxed.host.vertices.size() + relaxed.host.inside.size());
  std::size_t fixed = 0;
  if (const auto* shell = std::get_if<embedded::ShellHost>(&scene.host)) fixed = shell->fixed_vertices.size();
  if (const auto* solid = std::get_if<embedded::SolidHost>(&scene.host)) fixed = solid->fixed_vertices.size();
  return scene.scene.unknowns() + 3 * (nodes - static_cast<double>(fixed));
}

double total_length(const Relaxation& relaxed) {
  double sum = 0;
  for (const embedded::SpringState& spring : relaxed.springs) sum += spring.length;
  return sum;
}

namespace {

/// The octahedron's corners, turned away from the mesh's symmetries; opposite ones are three apart.
std::vector<Eigen::Vector3d> octahedron() {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  std::vector<Eigen::Vector3d> corners;
  for (const double side : {sphere_radius, -sphere_radius})
    for (int axis = 0; axis < 3; ++axis) corners.emplace_back(side * turn.col(axis));
  return corners;
}

std::vector<HostScene> shell_scenes(const NetworkSettings& settings) {
  const int fine = settings.brief ? 1 : 3;
  const std::vector<Eigen::Vector3d> few = octahedron();
  const std::vector<Eigen::Vector3d> many = points_on_sphere(settings.brief ? 0.4 : 0.2);
  const std::string points = "sphere, " + std::to_string(many.size()) + " points";
  std::vector<HostScene> scenes;
  scenes.push_back(shell_scene("sphere, 6 points", sphere(fine), few, 0, 10, 3, 1));
  if (settings.brief) return scenes;
  scenes.push_back(shell_scene("sphere, 6 points, inflated", sphere(fine), few, 0, 10, 3, 1.05));
  scenes.push_back(shell_scene(points, sphere(fine), many, 0.5, 10, 0, 1));
  scenes.push_back(shell_scene(points + ", inflated", sphere(fine), many, 0.5, 10, 0, 1.05));
  scenes.push_back(shell_scene(points + ", rest 0, inflated", sphere(fine), many, 0, 10, 4, 1.05));
  scenes.push_back(shell_scene(points + ", strong, inflated", sphere(fine), many, 0.5, 100, 0, 1.05));
  return scenes;
}

/// The mesh and the springs' paths of some scenes, for the pictures.
class Drawing {
 public:
  /// `after` must have paths.
  void add(const HostScene& scene, const Relaxation& after) {
    RelaxationOptions options = scene.options(thesis_gradient);
    options.paths = true;
    options.max_iterations = 0;
    draw(scene.scene.name, "before", embedded::relax(GeodesicSolver(scene.scene.mesh), scene.scene.network, options));
    draw(scene.scene.name, "after", after);
    for (const auto& [a, b, c] : scene.scene.mesh->faces())
      faces_.row({scene.scene.name, std::to_string(a), std::to_string(b), std::to_string(c)});
  }
  void write(Report& report) const {
    report.data(vertices_);
    report.data(faces_);
    report.data(paths_);
  }

 private:
  void draw(const std::string& name, const std::string& state, const Relaxation& relaxed) {
    const auto cells = [](std::vector<std::string> row, const Eigen::Vector3d& p) {
      for (const double x : p) row.push_back(number(x, 5));
      return row;
    };
    for (const Eigen::Vector3d& p : relaxed.host.vertices) vertices_.row(cells({name, state}, p));
    for (std::size_t i = 0; i < relaxed.springs.size(); ++i)
      for (const surface::PathPoint& at : relaxed.springs[i].path)
        paths_.row(cells({name, state, std::to_string(i)}, at.position));
  }

  Table vertices_{"hosts-figure-vertices",
                  {{"scene", "Scene"}, {"state", "State"}, {"x", "x"}, {"y", "y"}, {"z", "z"}}};
  Table faces_{"hosts-figure-faces", {{"scene", "Scene"}, {"a", "a"}, {"b", "b"}, {"c", "c"}}};
  Table paths_{"hosts-figure-paths",
               {{"scene", "Scene"}, {"state", "State"}, {"spring", "Spring"}, {"x", "x"}, {"y", "y"}, {"z", "z"}}};
};

/// The first iteration at which |g| is below the limit, if there is one.
std::optional<std::size_t> reached(const TimedRun& run, double limit) {
  for (std::size_t i = 0; i < run.steps.size(); ++i)
    if (run.steps[i].step.gradient_norm < limit) return i;
  return std::nullopt;
}

std::string tail_of(const TimedRun& run) {
  std::string tail;
  for (std::size_t i = run.steps.size() > 5 ? run.steps.size() - 5 : 0; i < run.steps.size(); ++i)
    tail += (tail.empty() ? "" : " ") + number(run.steps[i].step.gradient_norm, 2);
  return tail;
}

HostScene whole_rabbit(const NetworkSettings& settings) {
  return settings.brief ? rabbit_scene(2, 0.3, 1.3) : rabbit_scene(6, 0.11, 1.3);
}

/// Seconds of a Newton step by stage, each the least of several runs.
struct StepOfHost {
  double mean = std::numeric_limits<double>::infinity();
  double typical = mean;  ///< median of the last steps, which need one factorization and one trial
  double wall = mean;
  double search = mean;
  double host_derivatives = mean;
  double assembly = mean;
  double solve = mean;
  double motion = mean;

  void take(const TimedRun& run, bool cpu) {
    const std::size_t last = run.steps.size() - 1;
    const auto n = static_cast<double>(std::max<std::size_t>(1, last));
    const TimedStep& end = run.steps.back();
    const auto at = [&](std::size_t i) { return cpu ? run.steps[i].cpu_seconds : run.steps[i].wall_seconds; };
    std::vector<double> steps;
    for (std::size_t i = last > 4 ? last - 4 : 0; i < last; ++i) steps.push_back(at(i + 1) - at(i));
    if (steps.empty()) return;
    mean = std::min(mean, at(last) / n);
    typical = std::min(typical, median(steps));
    wall = std::min(wall, end.wall_seconds / n);
    search = std::min(search, end.search / n);
    host_derivatives = std::min(host_derivatives, end.host_derivatives / n);
    assembly = std::min(assembly, end.assembly / n);
    solve = std::min(solve, end.solve / n);
    motion = std::min(motion, end.motion / n);
  }

  std::vector<std::string> shares() const {
    std::vector<std::string> cells;
    double other = wall;
    for (const double part : {search, host_derivatives, assembly, solve, motion}) {
      cells.push_back(number(100 * part / wall, 2));
      other -= part;
    }
    cells.push_back(number(100 * std::max(0.0, other) / wall, 2));
    return cells;
  }
};

Table table_of_steps(const std::string& file) {
  return {file,
          {{"scene", "Scene"},
           {"unknowns", "Unknowns"},
           {"threads", "Threads"},
           {"steps", "Steps"},
           {"ms", "ms a step, mean"},
           {"typical_ms", "of the last"},
           {"search", "Search %"},
           {"host_derivatives", "Host derivatives %"},
           {"assembly", "Assembly %"},
           {"step", "Factorization and solution %"},
           {"motion", "Motion %"},
           {"other", "Other %"}}};
}

/// Adds a row for one thread and one for two threads. Returns the lower mean and the lower time of the last steps, in
/// ms.
std::pair<double, double> measure_steps_of(Table& table, const HostScene& scene, const RelaxationOptions& options,
                                           int repetitions) {
  const GeodesicSolver solver(scene.scene.mesh);
  double mean = std::numeric_limits<double>::infinity();
  double typical = mean;
  for (const int threads : {1, 2}) {
    set_thread_count(threads);
    StepOfHost time;
    TimedRun run;
    for (int i = 0; i < repetitions; ++i) {
      run = timed_run(solver, scene.scene.network, options);
      time.take(run, threads == 1);
    }
    std::vector<std::string> cells{scene.scene.name,        count(unknowns_of(scene, run.result)),
                                   std::to_string(threads), std::to_string(run.steps.size() - 1),
                                   number(1e3 * time.mean), number(1e3 * time.typical)};
    for (std::string& share : time.shares()) cells.push_back(std::move(share));
    table.row(std::move(cells));
    mean = std::min(mean, 1e3 * time.mean);
    typical = std::min(typical, 1e3 * time.typical);
  }
  return {mean, typical};
}

}  // namespace

void study_host_scenes(const NetworkSettings& settings) {
  Report report(settings.folder, "hosts", "scenes", "The scenes of the thesis");
  Table table("hosts-scenes", {{"scene", "Scene"},
                               {"faces", "Faces"},
                               {"points", "Points"},
                               {"springs", "Springs"},
                               {"unknowns", "Unknowns"},
                               {"iterations_6", "Iterations to 1e-6"},
                               {"cpu_ms", "CPU ms"},
                               {"iterations_10", "to 1e-10"},
                               {"stopped", "Stopped"},
                               {"moved", "Moved by, most / D"},
                               {"volume", "Volume"},
                               {"length", "Springs' length"},
                               {"tail", "Last \\|g\\|"}});
  set_thread_count(1);
  std::vector<HostScene> scenes = shell_scenes(settings);
  scenes.push_back(whole_rabbit(settings));
  std::size_t converged = 0;
  Drawing drawing;
  for (const HostScene& scene : scenes) {
    const GeodesicSolver solver(scene.scene.mesh);
    const bool shell = std::holds_alternative<embedded::ShellHost>(scene.host);
    RelaxationOptions options = scene.options(tight_host_gradient);
    options.paths = true;
    const TimedRun run = fastest_run(settings.brief || !shell ? 1 : 3, true, solver, scene.scene.network, options);
    const auto at = reached(run, thesis_gradient);
    converged += at ? 1 : 0;
    table.row({scene.scene.name, count(scene.scene.mesh->face_count()),
               std::to_string(scene.scene.network.points.size()), std::to_string(scene.scene.network.springs.size()),
               count(unknowns_of(scene, run.result)), at ? std::to_string(*at) : "-",
               at ? number(1e3 * run.steps[*at].cpu_seconds) : "-",
               reached(run, tight_host_gradient) ? std::to_string(*reached(run, tight_host_gradient)) : "-",
               std::string(to_string(run.result.stopped)),
               number(run.result.host.largest_displacement / scene.scene.mesh->diagonal()),
               number(run.result.host.volume_ratio, 5), number(total_length(run.result), 4), tail_of(run)});
    if (&scene - scenes.data() + 2 >= std::ssize(scenes)) drawing.add(scene, run.result);
  }
  report.target("Scenes with two-way coupling that reach a gradient of norm below 1e-6", "all",
                std::to_string(converged) + " of " + std::to_string(scenes.size()), converged == scenes.size());
  report.table(table);
  drawing.write(report);
  report.image("hosts-figure.svg", "A shell and a solid before and after their networks tighten");
  report.write(
      "network_bench host-scenes", settings.brief,
      "*Sphere*: a shell of 1,280 faces (thesis fig. 3.7), thickness 0.003, E 1e4, nu 0.48, volume weight 1e3, "
      "*inflated* to 1.05 times its volume or kept at 1; springs between neighbouring points, E = w / n sum (l - "
      "l0)^2, w = 10 (*strong*: 100). 6 points at the corners of an octahedron have springs of rest length 0 and two "
      "opposite points fixed; more points would contract to one, as they do on a rigid sphere: their springs are at "
      "rest at half of their first length and one point is fixed, or (*rest 0*) every fourth is. *Rabbit*, for the "
      "bunny of fig. 3.1: tetrahedra of E = 10, 1,000 in the top 15 % of the height, nu 0.49, the lowest 10 % fixed; "
      "springs of rest length 0, every sixth point fixed. All from the undeformed host. *To 1e-6* is where the thesis "
      "ends; the iteration goes on to 1e-10, and the last column has |g| after each of the last iterations.");
}

namespace {

void study_mean_steps(const NetworkSettings& settings) {
  Report report(settings.folder, "hosts", "steps", "Time of a Newton step");
  Table table = table_of_steps("hosts-steps");
  double shell_mean = 0;
  double shell_typical = 0;
  for (const HostScene& scene : shell_scenes(settings)) {
    const auto [mean, typical] = measure_steps_of(table, scene, scene.options(thesis_gradient), settings.brief ? 1 : 5);
    shell_mean = std::max(shell_mean, mean);
    shell_typical = std::max(shell_typical, typical);
  }
  const HostScene rabbit = whole_rabbit(settings);
  RelaxationOptions dozen = rabbit.options(thesis_gradient);
  dozen.max_iterations = 12;
  const auto [solid_mean, solid_typical] = measure_steps_of(table, rabbit, dozen, settings.brief ? 1 : 2);
  if (!settings.brief) {
    const auto both = [](double mean, double typical) {
      return number(mean) + " ms mean, " + number(typical) + " ms of the last";
    };
    report.target("A step of a shell of 1,280 faces, slowest of the scenes", "< 12 ms on two cores",
                  both(shell_mean, shell_typical), shell_mean < shell_limit_ms);
    report.target("A step of the rabbit of about 20,000 unknowns", "< 300 ms on two cores",
                  both(solid_mean, solid_typical), solid_mean < solid_limit_ms);
  }
  report.table(table);
  report.write(
      "network_bench host-steps", settings.brief,
      "*Mean* is over a whole run to |g| < 1e-6, of the rabbit over its first twelve steps, with all that line "
      "searches "
      "tried and all factorizations that failed on the way; *of the last* is the median of the last four steps, which "
      "of shells take one factorization and one trial each. Shares are of the wall time of the mean. The thesis gives "
      "130 ms for its sphere and 3.64 s for its bunny of 20,838 unknowns, on 64 cores.");
}

void study_solid_size(const NetworkSettings& settings) {
  Report report(settings.folder, "hosts", "size", "Size of a solid");
  Table sizes = table_of_steps("hosts-size");
  struct Size {
    int n;
    double element_size;
  };
  const std::vector<Size> all = settings.brief ? std::vector<Size>{{2, 1.3}}
                                               : std::vector<Size>{{3, 1.3}, {4, 1.3}, {6, 1.3}, {8, 1.2}, {11, 1.2}};
  std::vector<double> unknowns, ms;
  for (const auto& [n, element_size] : all) {
    HostScene scene = rabbit_scene(n, settings.brief ? 0.3 : 0.15, element_size);
    scene.scene.name = "rabbit, " + count(scene.scene.mesh->face_count()) + " faces";
    RelaxationOptions options = scene.options(0);
    options.max_iterations = 3;
    const auto [mean, typical] = measure_steps_of(sizes, scene, options, settings.brief || n > 8 ? 1 : 2);
    ms.push_back(mean);
    options.max_iterations = 0;
    unknowns.push_back(
        unknowns_of(scene, embedded::relax(GeodesicSolver(scene.scene.mesh), scene.scene.network, options)));
  }
  report.table(sizes);
  if (ms.size() > 2)
    report.text("Time grows as the unknowns to the power " + number(fitted_exponent(unknowns, ms)) +
                " (fitted): factorization, which fills in, takes over.");
  report.image("hosts-size.svg", "Time of a step against the number of unknowns");
  report.write(
      "network_bench host-steps", settings.brief,
      "The rabbit filled with smaller and smaller tetrahedra on finer and finer surfaces; the first three steps "
      "from the undeformed state.");
}

}  // namespace

void study_host_steps(const NetworkSettings& settings) {
  study_mean_steps(settings);
  study_solid_size(settings);
}

}  // namespace supple::bench
