#include "supple/surface/shortcuts.h"

#include <memory>
#include <string>

namespace supple::surface {

GeodesicSolver solver_on(const TriangleMesh& mesh, const Execution& execution) {
  return GeodesicSolver(std::shared_ptr<const TriangleMesh>(std::shared_ptr<const void>(), &mesh), execution);
}

double geodesic_distance(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                         const Execution& execution) {
  return solver_on(mesh, execution)
      .distance(checked_point(mesh, from, "from"), checked_point(mesh, to, "to"), execution);
}

double geodesic_distance(const Eigen::Ref<const Eigen::MatrixXd>& vertices,
                         const Eigen::Ref<const Eigen::MatrixXi>& faces, int from, int to) {
  const TriangleMesh mesh = mesh_of(vertices, faces);
  return geodesic_distance(mesh, vertex_point(mesh, VertexId{from}), vertex_point(mesh, VertexId{to}));
}

Geodesic shortest_path(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                       const GeodesicOptions& options, const Execution& execution) {
  return solver_on(mesh, execution)
      .geodesic(checked_point(mesh, from, "from"), checked_point(mesh, to, "to"), options, execution);
}

Eigen::VectorXd distances_from(const TriangleMesh& mesh, const std::vector<SurfacePoint>& sources,
                               const Execution& execution) {
  std::vector<SurfacePoint> checked;
  checked.reserve(sources.size());
  for (const SurfacePoint& source : sources)
    checked.push_back(checked_point(mesh, source, "sources/" + std::to_string(checked.size())));
  const GeodesicField field = solver_on(mesh, execution).field(checked, {}, execution);
  const std::vector<double>& distances = field.vertex_distances();
  return Eigen::Map<const Eigen::VectorXd>(distances.data(), static_cast<Eigen::Index>(distances.size()));
}

Eigen::VectorXd distances_from(const Eigen::Ref<const Eigen::MatrixXd>& vertices,
                               const Eigen::Ref<const Eigen::MatrixXi>& faces, const std::vector<int>& sources) {
  const TriangleMesh mesh = mesh_of(vertices, faces);
  return distances_from(mesh, vertex_points(mesh, sources));
}

KarcherMean karcher_mean(const TriangleMesh& mesh, const KarcherProblem& problem, const Execution& execution) {
  return karcher_mean(solver_on(mesh, execution), problem, execution);
}

KarcherMean karcher_mean(const Eigen::Ref<const Eigen::MatrixXd>& vertices,
                         const Eigen::Ref<const Eigen::MatrixXi>& faces, const std::vector<int>& points) {
  const TriangleMesh mesh = mesh_of(vertices, faces);
  KarcherProblem problem;
  problem.points = vertex_points(mesh, points);
  return karcher_mean(mesh, problem);
}

}  // namespace supple::surface
