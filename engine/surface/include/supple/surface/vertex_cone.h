#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "supple/surface/geodesic.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::surface {

/// The directions at a vertex, as counterclockwise angles around it in radians. They begin with 0 along halfedge
/// outgoing(v) and end with the sum of the corner angles, which is the direction 0 again at an interior vertex.
/// O(degree).
class VertexCone {
 public:
  VertexCone(const TriangleMesh& mesh, std::int32_t vertex);

  double total_angle() const { return total_angle_; }
  /// Whether the directions end at a boundary instead of closing up.
  bool open() const { return open_; }
  /// Whether shortest paths can bend at the vertex. For this two directions must be more than pi apart on either side.
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
    double begin;  ///< angle of the halfedge; the sector ends where the next one begins
  };

  const TriangleMesh& mesh_;
  std::vector<Sector> sectors_;
  double total_angle_ = 0;
  bool open_ = false;
};

/// One shortest path that ends at a vertex and arrives there from direction `angle`. If its end moves away from the
/// vertex at an angle a <= pi from this direction, the length falls at rate cos(a). In other directions it rises at
/// rate 1, because the path then continues through the vertex.
struct ArrivingPath {
  double angle;
  double weight;
};

struct SteepestDescent {
  double slope;  ///< least directional derivative; at least 0 at a local minimum
  double angle;  ///< the direction with that derivative
};

/// Finds the least value of D(u) = - sum w_i cos(min(angle between u and a_i, pi)), which is the directional derivative
/// of a weighted sum of distances at a vertex. Between the directions at which one of its terms changes its form, D is
/// a sinusoid, so that the least value is found exactly. O(arrivals^2).
SteepestDescent steepest_descent(const VertexCone& cone, std::span<const ArrivingPath> arrivals);

}  // namespace supple::surface
