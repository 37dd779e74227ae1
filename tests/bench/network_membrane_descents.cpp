// What makes a membrane's descent long: sheets that glide as a whole, and points that are pushed against a border.
#include <algorithm>
#include <cmath>

#include "measurement.h"
#include "network_membranes.h"
#include "supple/base/threads.h"
#include "supple/embedded/network_builders.h"
#include "support/shapes.h"

namespace supple::bench {
namespace {

using embedded::Relaxation;
using embedded::RelaxationOptions;
using surface::GeodesicSolver;
using surface::SurfacePoint;
using surface::TriangleMesh;

/// What happens in the iterations of one load step after the first.
struct Iterations {
  int count = 0;
  double way = 0;      ///< sum of the points' squared ways, mesh units squared
  double glide = 0;    ///< of that, what one turn of all points round the z axis would be
  double changed = 0;  ///< sides whose path crosses other edges than before, of all sides, summed over iterations
  double fall = 0;     ///< of E after the first iteration, relative
};

Iterations iterations_of(const StretchedTorus& scene, const PathStep& step, const PathOptions& options) {
  const GeodesicSolver solver(step.mesh);
  embedded::Network network = scene.membrane;
  network.points = step.start;
  Iterations told;
  std::vector<Eigen::Vector3d> before;
  std::vector<surface::TangentGeodesic> paths_before;
  RelaxationOptions own;
  own.tolerance = options.gradient / step.mesh->diagonal();
  own.max_iterations = options.max_iterations;
  own.mollifier = Switch::off;
  int seen = 0;
  own.observer = [&](const embedded::RelaxationStep&, std::span<const SurfacePoint> points, const TriangleMesh&) {
    std::vector<Eigen::Vector3d> places = positions_of(*step.mesh, {points.begin(), points.end()});
    std::vector<surface::PointPair> pairs;
    for (const auto& [a, b] : scene.sides)
      pairs.push_back({points[static_cast<std::size_t>(a)], points[static_cast<std::size_t>(b)]});
    std::vector<surface::TangentGeodesic> paths(pairs.size());
    solver.tangent_geodesics(pairs, paths, false);
    if (++seen > 2) {
      double along = 0, turn = 0, way = 0;
      for (std::size_t i = 0; i < places.size(); ++i) {
        const Eigen::Vector3d moved = places[i] - before[i];
        const Eigen::Vector3d round(-places[i][1], places[i][0], 0);
        way += moved.squaredNorm();
        along += moved.dot(round);
        turn += round.squaredNorm();
      }
      ++told.count;
      told.way += way;
      told.glide += along * along / turn;
      for (std::size_t i = 0; i < paths.size(); ++i)
        told.changed += std::ranges::equal(paths[i].strip.crossed(), paths_before[i].strip.crossed())
                            ? 0
                            : 1 / static_cast<double>(paths.size());
    }
    before = std::move(places);
    paths_before = std::move(paths);
  };
  const Relaxation end = embedded::relax(solver, network, own);
  if (end.history.size() > 2) told.fall = (end.history[1].energy - end.energy) / end.energy;
  return told;
}

void look_into_iterations(Report& report, const NetworkSettings& settings) {
  report.heading("What the iterations go into");
  Table table("membranes-glide", {{"steps_of", "Steps of"},
                                  {"steps", "Steps"},
                                  {"way", "Way of a point after the first iteration / h"},
                                  {"glide", "of that, gliding round the axis, %"},
                                  {"changed", "Sides that cross other edges, % an iteration"},
                                  {"fall", "E falls after the first iteration by at most, %"}});
  set_thread_count(1);
  const StretchedTorus scene = thesis_torus(settings, true);
  const PathOptions options{.mollifier = Switch::off};
  const std::vector<PathStep> path = follow_path(scene, options);
  struct Group {
    const char* words;
    int most;
    int steps = 0;
    Iterations sum{};
    double fall = 0;
  };
  std::vector<Group> groups{{"up to 4 iterations", 4}, {"5 to 7", 7}, {"8 and more", 1000}};
  std::size_t at_vertices = 0;
  for (const PathStep& step : path) {
    Group& group = *std::ranges::find_if(groups, [&](const Group& one) { return step.result.iterations <= one.most; });
    const Iterations told = iterations_of(scene, step, options);
    ++group.steps;
    group.fall = std::max(group.fall, told.fall);
    at_vertices += step.result.at_vertices.size();
    group.sum.count += told.count;
    group.sum.way += told.way;
    group.sum.glide += told.glide;
    group.sum.changed += told.changed;
  }
  const double points = static_cast<double>(scene.membrane.points.size());
  for (const Group& group : groups) {
    if (group.steps == 0 || group.sum.count == 0) continue;
    const double way = std::sqrt(group.sum.way / group.steps / points) / scene.rest->mean_edge_length();
    table.row({group.words, std::to_string(group.steps), number(way, 2),
               number(100 * group.sum.glide / group.sum.way, 2), number(100 * group.sum.changed / group.sum.count, 2),
               number(100 * group.fall, 2)});
  }
  report.text(
      "The path where one half is stretched, to \\|g\\| < 1e-6, from kept coordinates. The first iteration brings "
      "\\|g\\| from 0.03 to about 0.001, and two or three more converge quadratically once no side comes to cross "
      "other edges. What moves after the first iteration is mostly the whole sheet, which glides round the torus's "
      "axis, where nothing holds it; the share is that of one turn of all points in the squared ways. In the long "
      "steps it glides far. Where E falls much after the first iteration, the equilibrium that the sheet followed has "
      "ended, and it goes to another. The likely reason for many iterations on that way: each smooth piece of E is "
      "that of flat faces, and what the surface's curvature does to the stiffness of a glide is in the kinks between "
      "pieces, which a Newton step does not see; few of these steps are regularized or refused, they are too short, "
      "and doubled ones lead lower (below). The tolerance is not the main reason: a hundred times as much saves about "
      "one iteration (above). Nor are saddle vertices: " +
      std::to_string(at_vertices) + " points of all steps came to rest at one.");
  report.table(table);
}

void try_remedies(Report& report, const NetworkSettings& settings) {
  report.heading("What would shorten them");
  report.text(
      "The same path, to \\|g\\| < 1e-6, changed in one way. *Longer steps* double a step after an iteration by which "
      "\\|g\\| fell to no less than half, while E falls.");
  Table table("membranes-remedies", {{"what", "Changed"},
                                     {"mean", "Iterations, mean"},
                                     {"most", "Most"},
                                     {"failed", "Steps not converged"},
                                     {"mean_longer", "with longer steps, mean"},
                                     {"most_longer", "Most"},
                                     {"failed_longer", "Steps not converged"}});
  set_thread_count(1);
  struct Case {
    const char* what;
    StretchedTorus scene;
  };
  std::vector<Case> cases{{"nothing", thesis_torus(settings, true)}};
  if (!settings.brief) {
    cases.push_back({"one point held", thesis_torus(settings, true)});
    cases.back().scene.membrane.fixed_points = {0};
    cases.push_back({"three points held", thesis_torus(settings, true)});
    cases.back().scene.membrane.fixed_points = {0, 1, 2};
    cases.push_back({"25 load steps", thesis_torus(settings, true)});
    cases.back().scene.steps = 25;
    cases.push_back({"100 load steps", thesis_torus(settings, true)});
    cases.back().scene.steps = 100;
    cases.push_back({"Poisson's ratio 0: sides push less", thesis_torus(settings, true)});
    cases.back().scene.membrane.material.poisson_ratio = 0;
    cases.push_back({"a torus of 576 faces", stretched_torus(settings, true, 0.255, 16, 24)});
    cases.push_back({"a torus of 9,216 faces", stretched_torus(settings, true, 0.255, 16, 96)});
    cases.push_back({"all of the torus stretched", thesis_torus(settings, false)});
  }
  for (const Case& one : cases) {
    std::vector<std::string> cells{one.what};
    for (const bool longer : {false, true}) {
      std::vector<double> iterations;
      int failed = 0;
      for (const PathStep& step : follow_path(one.scene, {.longer_steps = longer, .mollifier = Switch::off})) {
        iterations.push_back(step.result.iterations);
        failed += step.result.stopped != "converged";
      }
      for (std::string& cell : std::vector<std::string>{number(mean(iterations)), number(quantile(iterations, 1), 3),
                                                        std::to_string(failed)})
        cells.push_back(std::move(cell));
    }
    table.row(std::move(cells));
  }
  report.table(table);
}

/// Points on edges of the boundary or at its vertices, but for rounding.
std::vector<std::int32_t> on_border(const TriangleMesh& mesh, const std::vector<SurfacePoint>& points) {
  constexpr double rounding = 1e-9;
  std::vector<std::int32_t> found;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::int32_t face = index(points[i].face);
    bool borders = false;
    for (int k = 0; k < 3; ++k)
      borders = borders || (mesh.twin(3 * face + k) < 0 && points[i].barycentric[(k + 2) % 3] < rounding);
    if (borders) found.push_back(static_cast<std::int32_t>(i));
  }
  return found;
}

void look_into_borders(Report& report, const NetworkSettings& settings) {
  report.heading("Free membranes with a border");
  report.text(
      "The graph of x^2 - y^2 over a square, 72 faces, with a membrane of random points that nothing holds. With a "
      "rest scale below 1 it contracts, stays off the border and comes to rest. With one above 1 it spreads until the "
      "border stops it: points come to rest against its edges like against a wall, where the gradient is what is left "
      "along the edge. *Then held*, to compare: the points that lie on the border at the end are fixed there, and the "
      "rest is relaxed.");
  Table table("membranes-border", {{"radius", "Radius / D"},
                                   {"scale", "Rest scale"},
                                   {"points", "Points"},
                                   {"stopped", "Stopped"},
                                   {"iterations", "Iterations"},
                                   {"gradient", "\\|g\\|"},
                                   {"border", "Points on the border"},
                                   {"held_stopped", "Then held"},
                                   {"held_iterations", "Iterations"},
                                   {"held_gradient", "\\|g\\|"},
                                   {"fall", "E falls by"}});
  Table history("membranes-border-history",
                {{"case", "Case"}, {"iteration", "Iteration"}, {"energy", "E"}, {"gradient", "|g|"}});
  set_thread_count(1);
  const auto mesh = testing::share(testing::saddle(6));
  const GeodesicSolver solver(mesh);
  RelaxationOptions options;
  options.max_iterations = settings.brief ? 40 : 1000;
  options.mollifier = Switch::off;
  for (const double radius : settings.brief ? std::vector<double>{0.2} : std::vector<double>{0.2, 0.1})
    for (const double scale : {0.8, 0.9, 1.05, 1.1}) {
      embedded::Network network;
      network.points = embedded::poisson_disk_points(solver, radius * mesh->diagonal());
      network.triangles = embedded::membrane_at_rest(solver, network.points,
                                                     embedded::triangulate(solver, network.points).triangles, scale);
      const Relaxation found = embedded::relax(solver, network, options);
      embedded::Network held = network;
      held.points = found.points;
      held.fixed_points = on_border(*mesh, found.points);
      const Relaxation rest = embedded::relax(solver, held, options);
      table.row({number(radius, 2), number(scale, 3), std::to_string(network.points.size()), found.stopped,
                 count(found.iterations), number(found.gradient_norm, 2), std::to_string(held.fixed_points.size()),
                 rest.stopped, count(rest.iterations), number(rest.gradient_norm, 2),
                 number(found.energy - rest.energy, 2)});
      const std::string name = "rest scale " + number(scale, 3);
      if (radius < 0.15 || settings.brief)
        for (std::size_t k = 0; k < found.history.size(); ++k)
          if (k < 50 || k % 25 == 0)
            history.row({name, std::to_string(k), number(found.history[k].energy, 10),
                         number(found.history[k].gradient_norm, 4)});
    }
  report.table(table);
  report.data(history);
  report.image("membranes-border.svg", "The gradient's norm over the iterations of free membranes");
}

}  // namespace

void measure_long_descents(Report& report, const NetworkSettings& settings) {
  look_into_iterations(report, settings);
  try_remedies(report, settings);
  look_into_borders(report, settings);
}

}  // namespace supple::bench
