#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

#include "edge_frames.h"
#include "supple/surface/surface_point.h"
#include "vertex_table.h"
#include "window.h"

namespace supple::surface {

/// How a path reaches a target.
struct Arrival {
  enum class Kind { none, direct, window, vertex, near_vertex } kind = Kind::none;
  double length = infinity;
  std::int32_t vertex = -1;
  std::int32_t source = -1;  ///< for direct arrivals and those near a vertex
  // For arrivals by a window: the halfedge at which it was queued, its trail, and where the path crosses the edge.
  std::int32_t halfedge = -1;
  std::int32_t origin = -1;  ///< as in a Window
  Trail trail = Trail::none();
  double crossing = 0;
  /// Preference among paths of equal length: 0 straight, 1 by a vertex that can bend paths, 2 bent at a window's end,
  /// which only approximates another path, 3 by another vertex.
  int rank = 0;
  /// The unfolded pseudo-source relative to the target, in the planar frame of side 0 of the target's face. For a
  /// target at a vertex, angles around the vertex are scaled to SearchMesh::turn_of_images.
  Eigen::Vector2d image = Eigen::Vector2d::Zero();
  /// The vertex at which the path is bent, in the coordinates of `image`; zero unless that vertex can bend paths.
  Eigen::Vector2d bend = Eigen::Vector2d::Zero();
};

/// A point whose distance is wanted, and what the search has found for it.
struct SearchTarget {
  SurfacePoint point;
  std::int32_t vertex = -1;               ///< the vertex on which the point lies exactly; -1 for none
  std::array<Eigen::Vector2d, 3> planar;  ///< the point in the frames of the three sides of its face
  Eigen::Vector3d position;
  Arrival best;
  double competing_length = infinity;  ///< length of the shortest path found with another image
};

/// The vertex of the point's face with the largest barycentric coordinate.
std::int32_t nearest_corner(const TriangleMesh& mesh, const SurfacePoint& point);
/// Vector to the point from a vertex of its face. It is computed from barycentric coordinates, and accurate relative to
/// its own length.
Eigen::Vector3d offset_from(const TriangleMesh& mesh, const SurfacePoint& point, std::int32_t vertex);
/// The point, or the vertex of its face from which rounding cannot distinguish it.
SurfacePoint rounded_to_vertex(const SurfacePoint& point);
SearchTarget make_target(const SearchMesh& mesh, const SurfacePoint& point);
/// Angle in radians at which the recorded path arrives at the vertex, counted as SearchMesh::polar_angle.
double arrival_angle(const SearchMesh& mesh, const VertexRecord& record, std::int32_t vertex);
/// Updates the target with the path by a corner of its face, whose distance and record are given. If the target is a
/// vertex, only that vertex's own record counts.
void update_by_vertex(const SearchMesh& mesh, SearchTarget& target, int corner, double distance,
                      const VertexRecord& record);
/// Updates the target with the path through a window of halfedge `h`.
void update_by_window(const SearchMesh& mesh, std::span<const SurfacePoint> sources, SearchTarget& target,
                      std::int32_t h, const Window& window);
/// Updates the target with the straight path from a source in its face or on an edge of it.
void update_by_direct_path(const SearchMesh& mesh, SearchTarget& target, const SurfacePoint& source, int source_index);
/// Finds the target's best path without a search if the target and a source lie close to the same vertex in different
/// faces. Returns whether it has found one. Among several such sources the nearest one counts, and only if no source
/// further from the vertex can be nearer to the target.
bool arrive_near_vertex(const SearchMesh& mesh, std::span<const SurfacePoint> sources, SearchTarget& target);
/// Length of the last straight segment of the recorded path.
double last_segment_length(const SearchMesh& mesh, const VertexRecord& record);
/// Updates the target's best arrival and its competing length with an arrival whose image is set.
void update_target(SearchTarget& target, const Arrival& arrival);

/// The (pseudo-)source `origin` of a window that comes straight from it, in the frame of the halfedge `h` where the
/// window arrives. The search uses the same numbers.
WindowSource first_source(const SearchMesh& mesh, std::span<const SurfacePoint> sources, std::int32_t origin,
                          std::int32_t h);

}  // namespace supple::surface
