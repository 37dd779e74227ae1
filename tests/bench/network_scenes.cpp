#include <utility>

#include "bill.h"
#include "network_bench.h"
#include "supple/embedded/network_builders.h"
#include "support/shapes.h"

namespace supple::bench {

using embedded::Network;
using embedded::Relaxation;

Scene face_scene(std::string name, surface::TriangleMesh mesh, const Eigen::Vector3d& barycentric) {
  Scene scene{std::move(name), testing::share(std::move(mesh)), {}};
  scene.network.points = embedded::points_in_faces(*scene.mesh, barycentric);
  const auto pairs = embedded::pairs_of_adjacent_faces(*scene.mesh, scene.network.points);
  const double weight = 1 / (2 * static_cast<double>(pairs.size()));
  for (const auto& [a, b] : pairs) {
    scene.network.springs.push_back({a, b, 0, weight});
    scene.network.springs.push_back({b, a, 0, weight});
  }
  return scene;
}

std::vector<Scene> face_scenes(const NetworkSettings& settings) {
  const Eigen::Vector3d near_vertex(0.99, 1e-6, 1 - 0.99 - 1e-6);
  const Eigen::Vector3d on_edge(0.5, 0.5 - 1e-6, 1e-6);
  std::vector<Scene> scenes;
  scenes.push_back(face_scene("torus, near vertices", testing::torus(24, 12), near_vertex));
  if (settings.brief) return scenes;
  scenes.push_back(face_scene("torus, on edges", testing::torus(24, 12), on_edge));
  scenes.push_back(face_scene("three holes, near vertices", testing::genus3(4), near_vertex));
  scenes.push_back(face_scene("three holes, on edges", testing::genus3(4), on_edge));
  scenes.push_back(face_scene("knot, near vertices", testing::trefoil_knot(80, 12), near_vertex));
  scenes.push_back(face_scene("knot, on edges", testing::trefoil_knot(80, 12), on_edge));
  return scenes;
}

void measure_scenes(Report& report, const NetworkSettings& settings) {
  report.heading("Scenes");
  report.text(
      "One point in each face and springs of rest length 0 to the points of the three neighbours (thesis fig. 3.4), "
      "from barycentric coordinates (0.99, 1e-6, rest), near vertices, and (0.5, 0.5 - 1e-6, 1e-6), on edges. Weights "
      "are 1 / (number of springs); a scene has converged at |g| < 1e-6. *last* is |g| after the last step over |g| "
      "before it: a quadratic tail makes it tiny.");
  Table table("networks-scenes", {{"scene", "Scene"},
                                  {"faces", "Faces"},
                                  {"unknowns", "Unknowns"},
                                  {"iterations", "Iterations"},
                                  {"stopped", "Stopped"},
                                  {"gradient", "\\|g\\|"},
                                  {"last", "last"},
                                  {"at_vertices", "At vertices"},
                                  {"wall_ms", "ms"}});
  Table history("networks-history", {{"scene", "Scene"}, {"iteration", "Iteration"}, {"energy", "E"}, {"gradient", "|g|"}});
  for (const Scene& scene : face_scenes(settings)) {
    const surface::GeodesicSolver solver(scene.mesh);
    embedded::RelaxationOptions options;
    options.tolerance = 1e-6 / (scene.mesh->diagonal() * scene.network.springs.front().weight);
    options.max_iterations = 500;
    const auto outcome = billed([&](const Execution& execution) {
      return embedded::relax(solver, scene.network, options, execution);
    });
    const Relaxation& relaxed = outcome.result;
    const auto& steps = relaxed.history;
    const double last = steps.size() > 1 ? steps.back().gradient_norm / steps[steps.size() - 2].gradient_norm : 0;
    table.row({scene.name, count(scene.mesh->face_count()), count(2.0 * static_cast<double>(scene.network.points.size())),
               std::to_string(relaxed.iterations), relaxed.stopped, number(relaxed.gradient_norm, 2), number(last, 2),
               std::to_string(relaxed.at_vertices.size()), number(1e3 * outcome.wall_seconds)});
    for (std::size_t i = 0; i < steps.size(); ++i)
      history.row({scene.name, std::to_string(i), number(steps[i].energy, 12), number(steps[i].gradient_norm, 6)});
  }
  report.table(table);
  report.data(history);
  report.image("networks-scenes.svg", "The gradient's norm over the iterations");
}

}  // namespace supple::bench
