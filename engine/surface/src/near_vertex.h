#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "edge_frames.h"
#include "supple/surface/surface_point.h"

namespace supple::surface {

/// The shortest path between two points that are much nearer to a vertex than the sides opposite it.
///
/// It stays in the fan of the vertex. Unfolding the fan gives it in closed form, from coordinates relative to the
/// vertex, which keep their digits however close to the vertex the points are. Windows would lose these digits, because
/// their coordinates have the rounding of an edge's length.
struct NearVertexPath {
  std::int32_t vertex;
  /// The corners of the vertex in which the ends lie, as outgoing halfedges.
  std::int32_t from_corner, to_corner;
  /// The ends in the frames of their corners.
  Eigen::Vector2d from, to;
  double length;
  /// Length of the straight path on the other side of the vertex; infinity if there is none.
  double competing_length;
  /// Angle in radians between the directions from the vertex to the two ends, on the side of the path; at least pi for
  /// a path through the vertex.
  double turn;
  bool clockwise;
  /// Angle in radians, counterclockwise around the vertex, from the end at which the counterclockwise path begins to
  /// the first edge.
  double angle_to_first_edge;
  /// The first straight segment as a vector in the frame of the first end's corner, and the last one in the frame of
  /// the second end's corner. A path that does not pass through the vertex has only one segment.
  Eigen::Vector2d departure, arrival;
  /// Points at least this far from the vertex are not near it. Mesh units.
  double near_radius;

  bool through_vertex() const;
};

/// The path between two points, if they lie near the same vertex in different faces, and neither is a vertex; else
/// nothing. O(faces of the vertex), or a few comparisons if one of the points is not near a vertex.
std::optional<NearVertexPath> path_near_vertex(const SearchMesh& mesh, const SurfacePoint& from,
                                               const SurfacePoint& to);

/// A crossing of an edge of the fan by a path that does not pass through the vertex.
struct FanCrossing {
  std::int32_t halfedge;  ///< outgoing halfedge of the vertex
  double x;               ///< distance from the vertex
};
/// The crossings of a path in order from its first end. Edges on which an end lies are not crossed.
std::vector<FanCrossing> fan_crossings(const SearchMesh& mesh, const NearVertexPath& path);

}  // namespace supple::surface
