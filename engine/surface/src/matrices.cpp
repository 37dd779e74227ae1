#include "supple/surface/matrices.h"

#include <stdexcept>
#include <utility>

#include "supple/numerics/rows.h"
#include "supple/surface/nearest_point.h"

namespace supple::surface {

TriangleMesh mesh_of(const Eigen::Ref<const Eigen::MatrixXd>& vertices, const Eigen::Ref<const Eigen::MatrixXi>& faces,
                     const Execution& execution) {
  return TriangleMesh::build(numerics::vectors_of<3>(vertices, "vertices"), numerics::groups_of<3>(faces, "faces"), {},
                             execution);
}

Eigen::MatrixXd vertices_of(const TriangleMesh& mesh) { return numerics::rows_of(mesh.positions()); }

Eigen::MatrixXi faces_of(const TriangleMesh& mesh) { return numerics::rows_of(mesh.faces()); }

Eigen::MatrixXd positions(const TriangleMesh& mesh, const std::vector<SurfacePoint>& points) {
  std::vector<Eigen::Vector3d> found;
  found.reserve(points.size());
  for (const SurfacePoint& point : points) found.push_back(position(mesh, point));
  return numerics::rows_of(found);
}

Eigen::MatrixXd positions(const std::vector<PathPoint>& path) {
  std::vector<Eigen::Vector3d> found;
  found.reserve(path.size());
  for (const PathPoint& point : path) found.push_back(point.position);
  return numerics::rows_of(found);
}

std::vector<SurfacePoint> vertex_points(const TriangleMesh& mesh, const std::vector<int>& vertices) {
  std::vector<SurfacePoint> points;
  points.reserve(vertices.size());
  for (const int v : vertices) points.push_back(vertex_point(mesh, VertexId{v}));
  return points;
}

std::vector<SurfacePoint> nearest_points(const TriangleMesh& mesh, const Eigen::Ref<const Eigen::MatrixXd>& positions,
                                         const Execution& execution) {
  if (!positions.allFinite()) throw std::invalid_argument("The matrix of positions has a number that is not finite.");
  const NearestPointSearch search(mesh, execution);
  std::vector<SurfacePoint> points;
  for (const Eigen::Vector3d& position : numerics::vectors_of<3>(positions, "positions"))
    points.push_back(search.find(position).point);
  return points;
}

}  // namespace supple::surface
