#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "edge_frames.h"
#include "supple/surface/surface_point.h"

namespace supple::surface {

/// The shortest path between two points that are much nearer to a vertex than the sides opposite it.
///
/// It stays in the fan of the vertex, and unfolding that gives it in closed form from coordinates that are counted from
/// the vertex: however close to it the points are, they keep their digits. Windows count from the ends of edges and
/// know a place to the rounding of an edge's length only.
struct NearVertexPath {
  std::int32_t vertex;
  /// Outgoing halfedges of the vertex: the corners that the ends lie in.
  std::int32_t from_corner, to_corner;
  /// The ends in the frames of their corners.
  Eigen::Vector2d from, to;
  double length;
  /// Of the straight path on the other side of the vertex; infinity where there is none.
  double competing_length;
  /// Angle under which the vertex sees the path, counterclockwise or clockwise; at least pi for a path through it.
  double turn;
  bool clockwise;
  /// From the end that is passed first when going round counterclockwise to the first edge on that way.
  double angle_to_first_edge;
  /// Vectors of travel: from the first end to the second or to the vertex, in the frame of the first end's corner; from
  /// the first end or the vertex to the second, in the frame of the second end's corner.
  Eigen::Vector2d departure, arrival;
  /// Points at least this far from the vertex are not near it.
  double reach;

  bool through_vertex() const;
};

/// The path, if the points lie inside two different faces of one vertex and near it. O(faces of the vertex); where one
/// of the points is not near a vertex, a few comparisons.
std::optional<NearVertexPath> path_near_vertex(const SearchMesh& mesh, const SurfacePoint& from,
                                               const SurfacePoint& to);

/// Where a path that does not pass through its vertex crosses an edge of the fan.
struct FanCrossing {
  std::int32_t halfedge;  ///< outgoing
  double x;               ///< distance from the vertex
};
/// In order from the first end. Edges on which an end lies are not crossed.
std::vector<FanCrossing> fan_crossings(const SearchMesh& mesh, const NearVertexPath& path);

}  // namespace supple::surface
