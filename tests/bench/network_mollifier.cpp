// A network whose spring passes a hyperbolic vertex at the equilibrium (thesis fig. 3.13), and what effects cost.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "measurement.h"
#include "network_bench.h"
#include "supple/base/threads.h"
#include "support/shapes.h"

namespace supple::bench {
namespace {

using embedded::Network;

constexpr double excess = 1;  ///< of the hyperbolic vertex's angle over 2 pi, in radians
constexpr double half_width = 0.5;
constexpr double half_height = 0.4;
/// The inner points' way from the equilibrium at the start.
constexpr double away = 0.2;
constexpr int most_effect_iterations = 60;

struct Variant {
  const char* name;
  double mollifier;  ///< 0 for none
};
constexpr Variant variants[] = {{"off", 0}, {"1e-6", 1e-6}, {"1e-3", 1e-3}, {"0.1", 0.1}};

/// A rectangle whose corners are held round the apex, with a crossbar between the middles of two sides. On the left
/// side of the bar's equilibrium the apex has the angle `left`: more than pi, and the bar is held at the apex whatever
/// small motion its ends make; exactly pi, and the equilibrium lies where the apex just begins to hold the bar, at
/// which the energy's second derivatives jump.
Network rectangle_with_bar(const surface::TriangleMesh& mesh, double left, double begin) {
  const double total = mesh.vertex_angle(0);
  const double corner = std::hypot(half_width, half_height);
  const double turn = std::atan2(half_height, half_width);
  const auto at = [&](double r, double angle) {
    return cone_point(mesh, cone_sectors, r, std::fmod(begin + angle, total));
  };
  Network network;
  network.points = {at(corner, turn), at(corner, left - turn), at(corner, left + turn), at(corner, total - turn)};
  // The bar's ends start beside their places, away from the side of the angle `left`.
  network.points.push_back(at(half_width, total - away));
  network.points.push_back(at(half_width, left + 2 * away));
  network.springs = {{0, 4, 0, 1}, {4, 3, 0, 1}, {1, 5, 0, 1}, {5, 2, 0, 1}, {4, 5, 0, 1}, {0, 1, 0, 1}, {2, 3, 0, 1}};
  network.fixed_points = {0, 1, 2, 3};
  return network;
}

void compare_convergence(Report& report, const NetworkSettings& settings) {
  report.heading("A spring through a hyperbolic vertex");
  report.text(
      "A rectangle with a crossbar round a vertex of angle 2 pi + 1 (thesis fig. 3.13, there on a deformable shell): "
      "the corners are held, the bar's ends slide, all springs have rest length 0, and at the equilibrium the bar "
      "passes the vertex. *Inside*: the vertex measures pi + 1/2 on both sides of the bar, and holds it. *Along "
      "edges*: "
      "the same, turned so that the bar comes to lie on edges of the mesh. *At the border*: the vertex measures "
      "exactly "
      "pi on one side, where it just begins to hold the bar and the energy's second derivatives jump. E and |g| are "
      "those of the energy that is minimized, with the mollifier the mollified one.");
  report.text(
      "Without the mollifier Newton's method converges quadratically in all three: paths that a vertex holds are found "
      "and differentiated exactly as two straight pieces, not as crossings near the end of an edge, and at the border "
      "each side of the jump is a smooth energy of its own, on one of which the iteration ends. The solver does not "
      "need "
      "the mollifier here, nor in any scene of this page. It does harm: where it is long, the mollified energy has "
      "other minima, and where a point comes to lie within rounding of an edge that its path crosses (*along edges*), "
      "the derivatives of the mollified length are lost to rounding and the search ends early. It stays off unless "
      "asked for, or unless a search fails with a path at a vertex.");
  Table table("networks-mollifier", {{"equilibrium", "Equilibrium"},
                                     {"mollifier", "Mollifier"},
                                     {"stopped", "Stopped"},
                                     {"iterations", "Iterations"},
                                     {"gradient", "\\|g\\|"},
                                     {"energy", "E"},
                                     {"exact_energy", "E of the exact lengths there"},
                                     {"bar_at_vertex", "Bar at the vertex"},
                                     {"cpu_ms", "CPU ms"}});
  Table history("networks-mollifier-history", {{"equilibrium", "Equilibrium"},
                                               {"mollifier", "Mollifier"},
                                               {"iteration", "Iteration"},
                                               {"energy", "E"},
                                               {"gradient", "|g|"}});
  const auto mesh = testing::share(testing::cone(cone_sectors, 2 * std::numbers::pi + excess));
  const surface::GeodesicSolver solver(mesh);
  const double total = mesh->vertex_angle(0);
  // Where the bar's right half lies in its sector.
  const double beside = 0.3 * total / cone_sectors;
  struct Place {
    const char* name;
    double left;
    double begin;
  };
  for (const Place& place : {Place{"inside", total / 2, beside}, Place{"along edges", total / 2, 0},
                             Place{"at the border", std::numbers::pi, beside}}) {
    const Network network = rectangle_with_bar(*mesh, place.left, place.begin);
    for (const Variant& variant : variants) {
      embedded::RelaxationOptions options;
      options.tolerance = 1e-13;
      options.mollifier = variant.mollifier > 0 ? Switch::on : Switch::off;
      if (variant.mollifier > 0) options.mollifier_length = variant.mollifier;
      const TimedRun run = fastest_run(settings.brief ? 1 : 5, true, solver, network, options);
      double exact = 0;
      for (const embedded::Spring& spring : network.springs)
        exact += spring.weight * std::pow(solver.distance(run.result.points[static_cast<std::size_t>(spring.from)],
                                                          run.result.points[static_cast<std::size_t>(spring.to)]),
                                          2);
      const bool at_vertex = !solver.geodesic(run.result.points[4], run.result.points[5]).pinned_at.empty();
      table.row({place.name, variant.name, run.result.stopped, std::to_string(run.result.iterations),
                 number(run.result.gradient_norm, 2), number(run.result.energy, 12), number(exact, 12),
                 at_vertex ? "yes" : "no", number(1e3 * run.cpu_seconds)});
      for (std::size_t i = 0; i < run.steps.size(); ++i)
        history.row({place.name, variant.name, std::to_string(i), number(run.steps[i].step.energy, 14),
                     number(run.steps[i].step.gradient_norm, 6)});
    }
  }
  report.table(table);
  report.data(history);
  report.image("networks-mollifier.svg", "The gradient's norm over the iterations with and without mollifier");
}

void bill_effects(Report& report, const NetworkSettings& settings) {
  report.heading("What the effects cost");
  report.text(
      "Runs to |g| < 1e-6 (at most 60 iterations) of the whole call, one thread, with each effect on and off. Kept "
      "strips never change the answer. The mollifier has no strips to unfold: it needs each path in full.");
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
      options.max_iterations = most_effect_iterations;
      options.kept_strips = strips ? Switch::on : Switch::off;
      options.mollifier = mollifier > 0 ? Switch::on : Switch::off;
      if (mollifier > 0) options.mollifier_length = mollifier;
      const TimedRun run = fastest_run(settings.brief || mollifier > 0 ? 1 : 5, true, solver, scene.network, options);
      const double ms = 1e3 * run.cpu_seconds;
      table.row({scene.name, strips ? "on" : "off", mollifier > 0 ? number(mollifier, 1) : "off",
                 std::to_string(run.result.iterations), run.result.stopped, number(run.result.gradient_norm, 2),
                 number(run.result.energy, 10), number(ms), number(ms / std::max(1, run.result.iterations))});
    };
    row(true, 0);
    row(false, 0);
    row(true, 1e-6);
    row(true, 1e-3);
  }
  report.table(table);
}

}  // namespace

void measure_mollified_networks(Report& report, const NetworkSettings& settings) {
  set_thread_count(1);
  compare_convergence(report, settings);
  bill_effects(report, settings);
}

}  // namespace supple::bench
