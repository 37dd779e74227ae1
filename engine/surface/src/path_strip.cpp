#include "path_strip.h"

#include "halfedge_frame.h"

namespace supple::surface {

std::vector<std::int32_t> faces_around(const TriangleMesh& mesh, const SurfacePoint& point) {
  const std::int32_t first = 3 * index(point.face);
  if (const int corner = corner_of(point); corner >= 0) {
    std::vector<std::int32_t> corners;
    const std::int32_t start = mesh.outgoing(mesh.tail(first + corner));
    std::int32_t h = start;
    do {
      corners.push_back(h);
      h = mesh.rotate(h);
    } while (h >= 0 && h != start);
    return corners;
  }
  if (const int side = side_of(point); side >= 0) {
    const std::int32_t twin = mesh.twin(first + side);
    return twin >= 0 ? std::vector{first + side, twin} : std::vector{first + side};
  }
  return {first};
}

std::int32_t common_face(const TriangleMesh& mesh, const SurfacePoint& a, const SurfacePoint& b) {
  std::int32_t found = -1;
  for (const std::int32_t h : faces_around(mesh, a)) {
    for (const std::int32_t k : faces_around(mesh, b)) {
      if (TriangleMesh::face_of(h) != TriangleMesh::face_of(k)) continue;
      if (found < 0 || TriangleMesh::face_of(h) == index(a.face)) found = h;
    }
  }
  return found;
}

UnfoldedStrip::UnfoldedStrip(const TriangleMesh& mesh, std::int32_t h)
    : mesh_(mesh), h_(h), into_plane_(halfedge_frame(mesh, h).transpose()), at_(mesh.positions()[mesh.tail(h)]) {}

Eigen::Vector2d UnfoldedStrip::position_of(std::int32_t vertex) const {
  for (int i = 0; i < 2; ++i) {
    if (edge_vertices_[i] == vertex) return edge_positions_[i];
  }
  return in_plane(mesh_.positions()[vertex]);
}

UnfoldedStrip::Edge UnfoldedStrip::unfold_across(std::int32_t over) {
  Edge edge{position_of(mesh_.tail(over)), position_of(mesh_.head(over))};
  edge_vertices_ = {mesh_.tail(over), mesh_.head(over)};
  edge_positions_ = {edge.tail, edge.head};
  h_ = mesh_.twin(over);
  // The twin has the opposite direction, and its face lies on the other side.
  const Eigen::Vector2d along = (edge.tail - edge.head).normalized();
  Eigen::Matrix2d axes;
  axes << along.x(), -along.y(), along.y(), along.x();
  into_plane_ = axes * halfedge_frame(mesh_, h_).transpose();
  at_ = mesh_.positions()[mesh_.tail(h_)];
  at_in_plane_ = edge.head;
  return edge;
}

}  // namespace supple::surface
