// Networks on shells and solids: accuracy against time, by tolerance and by mesh, and what each effect changes and
// costs.
#include <algorithm>
#include <cmath>
#include <utility>

#include "measurement.h"
#include "network_hosts.h"
#include "supple/base/threads.h"
#include "support/shapes.h"

namespace supple::bench {
namespace {

using embedded::Relaxation;
using embedded::RelaxationOptions;
using embedded::ShellHost;
using surface::GeodesicSolver;

constexpr int max_host_iterations = 500;

/// Positions of the network's points, and after them of the host's vertices unless it is rigid.
std::vector<Eigen::Vector3d> places_of(const HostScene& scene, const Relaxation& relaxed) {
  const surface::TriangleMesh& rest = *scene.scene.mesh;
  if (relaxed.host.vertices.empty()) return positions_of(rest, relaxed.points);
  std::vector<Eigen::Vector3d> places = positions_of(rest.with_positions(relaxed.host.vertices), relaxed.points);
  places.insert(places.end(), relaxed.host.vertices.begin(), relaxed.host.vertices.end());
  return places;
}

std::vector<Eigen::Vector3d> points_of(const HostScene& scene, const Relaxation& relaxed) {
  std::vector<Eigen::Vector3d> places = places_of(scene, relaxed);
  places.resize(relaxed.points.size());
  return places;
}

HostScene inflated_sphere(const NetworkSettings& settings, int subdivisions) {
  return shell_scene("sphere, inflated", sphere(subdivisions), points_on_sphere(settings.brief ? 0.4 : 0.2), 0.5, 10, 0,
                     1.05);
}

HostScene small_rabbit(const NetworkSettings& settings) {
  return settings.brief ? rabbit_scene(2, 0.3, 1.3) : rabbit_scene(4, 0.13, 1.3);
}

void study_host_tolerance(const NetworkSettings& settings) {
  Report report(settings.folder, "hosts", "accuracy", "Error against time: the tolerance");
  Table table("hosts-accuracy", {{"scene", "Scene"},
                                 {"tolerance", "|g| below"},
                                 {"iterations", "Iterations"},
                                 {"cpu_ms", "CPU ms"},
                                 {"energy_error", "Error of E, relative"},
                                 {"position_error", "Error of positions / D"}});
  set_thread_count(1);
  std::vector<HostScene> scenes;
  scenes.push_back(inflated_sphere(settings, settings.brief ? 1 : 3));
  scenes.push_back(small_rabbit(settings));
  for (const HostScene& scene : scenes) {
    const GeodesicSolver solver(scene.scene.mesh);
    const Relaxation tight = embedded::relax(solver, scene.scene.network, scene.options(1e-12));
    const auto right = places_of(scene, tight);
    for (int digits = 2; digits <= 10; ++digits) {
      const double tolerance = std::pow(10.0, -digits);
      const TimedRun run =
          fastest_run(settings.brief ? 1 : 3, true, solver, scene.scene.network, scene.options(tolerance));
      const double moved = largest_distance(places_of(scene, run.result), right) / scene.scene.mesh->diagonal();
      table.row({scene.scene.name, number(tolerance, 1), std::to_string(run.result.iterations),
                 number(1e3 * run.cpu_seconds), number(std::abs(run.result.energy / tight.energy - 1), 2),
                 number(moved, 2)});
    }
  }
  report.table(table);
  report.image("hosts-accuracy.svg", "Errors against time and tolerance");
  report.write(
      "network_bench host-accuracy", settings.brief,
      "Runs that end at |g| below a tolerance, against the same to 1e-12. Positions are those of points and of "
      "vertices of the host, the farthest from where they should be. Newton's last steps gain so many digits that a "
      "tight tolerance costs hardly more than a loose one; a loose one is not safe, since |g| falls and rises on the "
      "way, as faces fold and points cross edges.");
}

void study_host_refinement(const NetworkSettings& settings) {
  Report report(settings.folder, "hosts", "refinement", "Error against time: the host's mesh");
  Table table("hosts-refinement", {{"shell", "Shell"},
                                   {"faces", "Faces"},
                                   {"unknowns", "Unknowns"},
                                   {"iterations", "Iterations"},
                                   {"cpu_ms", "CPU ms"},
                                   {"energy", "E"},
                                   {"energy_error", "Error of E, relative"},
                                   {"length_error", "of the springs' length"},
                                   {"moved", "Moved by, most / D"},
                                   {"position_error", "Error of points / D"}});
  set_thread_count(1);
  const int finest = settings.brief ? 2 : 5;
  for (const bool thick : {false, true}) {
    struct Solved {
      HostScene scene;
      TimedRun run;
    };
    std::vector<Solved> solved;
    for (int subdivisions = settings.brief ? 1 : 2; subdivisions <= finest; ++subdivisions) {
      HostScene scene = inflated_sphere(settings, subdivisions);
      if (thick) {
        auto& shell = std::get<ShellHost>(scene.host);
        shell.thickness *= 10;
        shell.youngs_modulus /= 10;
      }
      const GeodesicSolver solver(scene.scene.mesh);
      RelaxationOptions options = scene.options(thesis_gradient);
      options.max_iterations = max_host_iterations;
      const int repetitions = settings.brief || subdivisions > 4 ? 1 : 2;
      TimedRun run = fastest_run(repetitions, true, solver, scene.scene.network, options);
      solved.push_back({std::move(scene), std::move(run)});
    }
    const Solved& best = solved.back();
    const auto right = points_of(best.scene, best.run.result);
    const auto off = [](double value, double exact) { return number(std::abs(value / exact - 1), 2); };
    for (const Solved& own : solved) {
      const Relaxation& found = own.run.result;
      const bool last = &own == &best;
      table.row({thick ? "thick" : "thin", count(own.scene.scene.mesh->face_count()),
                 count(unknowns_of(own.scene, found)),
                 std::to_string(found.iterations) + (found.stopped == embedded::RelaxationTermination::converged
                                                         ? ""
                                                         : ", " + std::string(to_string(found.stopped))),
                 number(1e3 * own.run.cpu_seconds), number(found.energy, 6),
                 last ? "-" : off(found.energy, best.run.result.energy),
                 last ? "-" : off(total_length(found), total_length(best.run.result)),
                 number(found.host.largest_displacement),
                 last ? "-" : number(largest_distance(points_of(own.scene, found), right), 2)});
    }
  }
  report.table(table);
  report.image("hosts-refinement.svg", "Errors against the host's number of faces and against time");
  report.write(
      "network_bench host-accuracy", settings.brief,
      "The inflated sphere on finer and finer meshes, to |g| < 1e-6, the network's points started from the same places "
      "in space. *Thin* is the thesis's shell, *thick* ten times as thick with a tenth of the modulus, which hardly "
      "wrinkles. Errors are against the finest mesh: of the energy, of the springs' length together, of how far the "
      "host moves at most, and of the points' places. A thin shell folds along edges under a tight spring: its folds "
      "are as sharp as the mesh lets them be, and each mesh has equilibria of its own.");
}

}  // namespace

void study_host_accuracy(const NetworkSettings& settings) {
  study_host_tolerance(settings);
  study_host_refinement(settings);
}

void study_host_effects(const NetworkSettings& settings) {
  Report report(settings.folder, "hosts", "effects", "What the effects change and cost");
  Table table("hosts-effects", {{"scene", "Scene"},
                                {"off", "Off"},
                                {"iterations", "Iterations"},
                                {"stopped", "Stopped"},
                                {"cpu_ms", "CPU ms"},
                                {"step_ms", "a step"},
                                {"network_energy", "E of the network"},
                                {"length", "Springs' length"},
                                {"moved", "Host moved by, most / D"},
                                {"volume", "Volume"},
                                {"points_off", "Points off / D"}});
  set_thread_count(1);
  std::vector<std::pair<std::string, HostScene>> cases;
  const int subdivisions = settings.brief ? 1 : 3;
  for (const char* off : {"nothing", "coupling", "volume", "bending"}) {
    HostScene scene = inflated_sphere(settings, subdivisions);
    auto& shell = std::get<ShellHost>(scene.host);
    if (std::string(off) == "volume") shell.volume_weight = 0;
    if (std::string(off) == "bending") shell.bending = false;
    if (std::string(off) == "coupling") scene.host = embedded::RigidHost{};
    cases.emplace_back(off, std::move(scene));
  }
  for (const char* off : {"nothing", "coupling"}) {
    HostScene scene = small_rabbit(settings);
    if (std::string(off) == "coupling") scene.host = embedded::RigidHost{};
    cases.emplace_back(off, std::move(scene));
  }
  std::vector<Eigen::Vector3d> with_all;
  for (const auto& [off, scene] : cases) {
    const GeodesicSolver solver(scene.scene.mesh);
    RelaxationOptions options = scene.options(thesis_gradient);
    options.max_iterations = max_host_iterations;
    const TimedRun run = fastest_run(settings.brief ? 1 : 3, true, solver, scene.scene.network, options);
    const auto points = points_of(scene, run.result);
    if (off == "nothing") with_all = points;
    const bool rigid = run.result.host.vertices.empty();
    table.row({scene.scene.name, off, std::to_string(run.result.iterations), std::string(to_string(run.result.stopped)),
               number(1e3 * run.cpu_seconds), number(1e3 * run.cpu_seconds / std::max(1, run.result.iterations)),
               number(run.result.network_energy, 5), number(total_length(run.result), 4),
               rigid ? "-" : number(run.result.host.largest_displacement),
               rigid ? "-" : number(run.result.host.volume_ratio, 5),
               number(largest_distance(points, with_all) / scene.scene.mesh->diagonal(), 2)});
  }
  report.table(table);
  report.write(
      "network_bench host-effects", settings.brief,
      "The same network to |g| < 1e-6 (at most 500 iterations) with one effect switched off: *coupling* (a rigid "
      "host), the kept *volume* (volume weight 0), *bending* (no hinges). *Points off* is the farthest that a point of "
      "the network lies from where it is with all effects.");
}

}  // namespace supple::bench
