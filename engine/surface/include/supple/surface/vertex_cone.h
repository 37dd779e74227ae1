#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "supple/surface/geodesic.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::surface {

/// The directions at a vertex, as counterclockwise angles around it. They begin with 0 along halfedge outgoing(v) and
/// end with the sum of the corner angles, where an interior vertex begins again. O(degree).
class VertexCone {
 public:
  VertexCone(const TriangleMesh& mesh, std::int32_t vertex);

  double total_angle() const { return total_angle_; }
  /// Whether the directions end at a boundary instead of closing up.
  bool open() const { return open_; }
  /// Whether shortest paths can bend at the vertex. This needs more than pi between two directions on either side.
  bool bends_paths() const;

  /// The angle of the shorter turn between two directions. At an open vertex there is only one turn.
  double between(double a, double b) const;

  /// The direction of the straight segment from the vertex to `neighbour`, which is a point in one of its faces; NaN if
  /// it lies in none of them.
  double angle_to(const SurfacePoint& neighbour) const;

  struct Direction {
    SurfacePoint vertex;     ///< the vertex, written in the face that the direction points into
    Eigen::Vector3d vector;  ///< unit vector within that face
  };
  /// The direction at an angle within [0, total_angle()].
  Direction direction(double angle) const;

 private:
  struct Sector {
    std::int32_t halfedge;
    double begin;  ///< angle of the halfedge; the sector ends at the next sector's
  };

  const TriangleMesh& mesh_;
  std::vector<Sector> sectors_;
  double total_angle_ = 0;
  bool open_ = false;
};

/// One shortest path that ends at a vertex: its length falls at rate cos(angle) towards directions within pi of
/// `angle`, and rises at rate 1 towards others, to which the path continues through the vertex.
struct ArrivingPath {
  double angle;
  double weight;
};

struct SteepestDescent {
  double slope;  ///< least directional derivative; at least 0 at a local minimum
  double angle;  ///< the direction that has it
};

/// Finds the least value of D(u) = - sum w_i cos(min(angle between u and a_i, pi)), which is the directional derivative
/// of a weighted sum of distances at a vertex. D is a sinusoid between the directions where a term changes its form, so
/// that the least value is found exactly. O(arrivals^2).
SteepestDescent steepest_descent(const VertexCone& cone, std::span<const ArrivingPath> arrivals);

}  // namespace supple::surface
