#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "supple/surface/geodesic.h"

namespace supple::surface {

/// Faces that hold a point: one, two or a vertex's fan, as halfedges of the face (the point's side or corner).
std::vector<std::int32_t> faces_around(const TriangleMesh& mesh, const SurfacePoint& point);

/// The halfedge at `a` (as in faces_around) of a face that holds both points; a's own face if it does, -1 if none does.
std::int32_t common_face(const TriangleMesh& mesh, const SurfacePoint& a, const SurfacePoint& b);

/// Whether a path crosses an edge there, and not a vertex.
inline bool crosses_edge(const PathPoint& point) { return point.vertex == VertexId::none && side_of(point.point) >= 0; }

/// Faces laid into one plane, each over the edge that it shares with the one before.
class UnrolledStrip {
 public:
  struct Edge {
    Eigen::Vector2d tail, head;
  };

  /// Begins with the face of h, whose tail becomes the origin and whose head lies on the x axis.
  UnrolledStrip(const TriangleMesh& mesh, std::int32_t h);

  /// A halfedge of the last face.
  std::int32_t halfedge() const { return h_; }
  /// Turns vectors of the last face into the plane; its transpose turns them back.
  const Eigen::Matrix<double, 2, 3>& into_plane() const { return into_plane_; }
  /// A point of the last face.
  Eigen::Vector2d place(const Eigen::Vector3d& point) const { return at_in_plane_ + into_plane_ * (point - at_); }
  /// Lays the face on the other side of `over`, a halfedge of the last face, and says where `over` lies.
  Edge cross(std::int32_t over);

 private:
  Eigen::Vector2d place_of(std::int32_t vertex) const;

  const TriangleMesh& mesh_;
  std::int32_t h_;
  Eigen::Matrix<double, 2, 3> into_plane_;
  Eigen::Vector3d at_;
  Eigen::Vector2d at_in_plane_ = Eigen::Vector2d::Zero();
  // The edges of one vertex get one place for it: crossings next to it are told apart by their offsets.
  std::array<std::int32_t, 2> known_vertices_{-1, -1};
  std::array<Eigen::Vector2d, 2> known_places_;
};

}  // namespace supple::surface
