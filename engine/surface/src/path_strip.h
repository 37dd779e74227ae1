#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "supple/surface/geodesic.h"

namespace supple::surface {

/// The faces that contain a point: one, two, or the fan of a vertex. Each is given by one of its halfedges: the side on
/// which the point lies, or the halfedge whose tail the point is.
std::vector<std::int32_t> faces_around(const TriangleMesh& mesh, const SurfacePoint& point);

/// The halfedge at `a` (as in faces_around) of a face that contains both points, which is a's own face if possible; -1
/// if there is none.
std::int32_t common_face(const TriangleMesh& mesh, const SurfacePoint& a, const SurfacePoint& b);

/// Whether the path crosses an edge at this point, and not a vertex.
inline bool crosses_edge(const PathPoint& point) { return point.vertex == VertexId::none && side_of(point.point) >= 0; }

/// A strip of faces that is unfolded into the plane, one face after the other.
class UnfoldedStrip {
 public:
  struct Edge {
    Eigen::Vector2d tail, head;
  };

  /// A strip of one face, that of h. The tail of h becomes the origin, and its head lies on the x axis.
  UnfoldedStrip(const TriangleMesh& mesh, std::int32_t h);

  /// A halfedge of the last face.
  std::int32_t halfedge() const { return h_; }
  /// Maps vectors within the last face to the plane; its transpose maps them back.
  const Eigen::Matrix<double, 2, 3>& into_plane() const { return into_plane_; }
  /// A point of the last face in the plane.
  Eigen::Vector2d in_plane(const Eigen::Vector3d& point) const { return at_in_plane_ + into_plane_ * (point - at_); }
  /// Unfolds the face on the other side of `over`, a halfedge of the last face. Returns `over` in the plane.
  Edge unfold_across(std::int32_t over);

 private:
  Eigen::Vector2d position_of(std::int32_t vertex) const;

  const TriangleMesh& mesh_;
  std::int32_t h_;
  Eigen::Matrix<double, 2, 3> into_plane_;
  Eigen::Vector3d at_;
  Eigen::Vector2d at_in_plane_ = Eigen::Vector2d::Zero();
  // The vertices of the edge that was crossed last, and their positions in the plane. Edges that share a vertex get the
  // same position for it, so that crossings next to it differ by their offsets only.
  std::array<std::int32_t, 2> edge_vertices_{-1, -1};
  std::array<Eigen::Vector2d, 2> edge_positions_;
};

}  // namespace supple::surface
