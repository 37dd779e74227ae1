#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <numbers>
#include <span>
#include <vector>

#include "supple/base/execution.h"
#include "supple/surface/surface_point.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::surface {

/// Whether a vertex can bend a shortest path: saddle and boundary vertices can.
bool bends_paths(const TriangleMesh& mesh, std::int32_t v);

/// The frame of one halfedge h for window propagation. Its face lies in the plane with the tail of h at the origin, the
/// head on the positive x axis and the apex above it. One cache line.
struct alignas(64) EdgeFrame {
  double length;
  double apex_offset;  ///< x of the apex relative to that end of h from which it is smaller in magnitude
  double apex_y;
  double left_length;   ///< length of the edge between tail and apex
  double right_length;  ///< length of the edge between apex and head
  std::int32_t left;    ///< twin of previous(h), from tail to apex in the next face; -1 on the boundary
  std::int32_t right;   ///< twin of next(h), from apex to head in the next face; -1 on the boundary
  std::int32_t tail, head, apex;
  std::int32_t offset_from_head;  ///< 1 if apex_offset is relative to the head, else 0

  double apex_x() const { return (offset_from_head ? length : 0) + apex_offset; }
  /// length - apex_x without cancellation. Divided by right_length it is a component of the right edge's direction,
  /// even if that edge is short.
  double right_x() const { return (offset_from_head ? 0 : length) - apex_offset; }

  /// (ux, uy), by which source_across_left and source_across_right rotate a window's source into the frames of the
  /// halfedges `left` and `right`. `left` has this direction in the frame of h, `right` its mirror image (ux, -uy).
  struct Direction {
    double x, y;
  };
  Direction left_direction() const {
    const double scale = 1 / left_length;
    return {apex_x() * scale, apex_y * scale};
  }
  Direction right_direction() const {
    const double scale = 1 / right_length;
    return {right_x() * scale, apex_y * scale};
  }
};
static_assert(sizeof(EdgeFrame) == 64);

/// A corner in the fan of faces around a vertex.
struct FanCorner {
  double polar_angle;     ///< sum of the corner angles before this one, beginning at TriangleMesh::outgoing; radians
  double angle;           ///< angle of this corner; radians
  std::int32_t halfedge;  ///< outgoing halfedge with the corner on its left
  std::int32_t across;  ///< twin of the side opposite the vertex, where the vertex's windows arrive; -1 on the boundary
};

/// A side of a face is short if it is below this fraction of another one. The direction from one of its ends to the
/// other has then lost more digits than the tolerances allow for.
inline constexpr double short_side_ratio = 1e-4;

/// A mesh with the tables that all searches on it share.
struct SearchMesh {
  explicit SearchMesh(std::shared_ptr<const TriangleMesh> mesh, const Execution& execution = {});

  /// bends_paths, read from a table.
  bool pins(std::int32_t vertex) const { return pins_paths[vertex] != 0; }

  /// The angle in radians to which the total angle of a vertex is scaled where points around it are mapped to the
  /// plane. At a boundary it is half a turn, so that the two sides of the boundary stay apart.
  double turn_of_images(std::int32_t vertex) const {
    return mesh->is_boundary(vertex) ? std::numbers::pi : 2 * std::numbers::pi;
  }

  /// Memory without that of the mesh.
  std::size_t memory_bytes() const;

  std::shared_ptr<const TriangleMesh> mesh;
  std::vector<EdgeFrame> frames;
  std::vector<std::uint8_t> pins_paths;
  double longest_edge = 0;
  bool has_needles = false;  ///< a face has a side below short_side_ratio of another side
  std::span<const FanCorner> fan(std::int32_t vertex) const {
    return {corners.data() + first_corner[vertex], corners.data() + first_corner[vertex + 1]};
  }
  /// Polar angle of halfedge h around its tail; radians.
  double polar_angle(std::int32_t h) const {
    for (const FanCorner& corner : fan(frames[h].tail)) {
      if (corner.halfedge == h) return corner.polar_angle;
    }
    return 0;
  }

  /// The fans of all vertices in the order of the vertices, each counterclockwise.
  std::vector<FanCorner> corners;
  std::vector<std::int32_t> first_corner;  ///< index in `corners` of each vertex's fan; last, the size of `corners`
};

/// Planar coordinates of a point in the frame of halfedge 3 f + side. Its barycentric coordinates are those in face f.
Eigen::Vector2d planar_point(const EdgeFrame& frame, const Eigen::Vector3d& barycentric, int side);

/// Barycentric coordinates of a point on a side of its face in the other face of that side. `across` is the halfedge
/// there, whose ends are swapped.
Eigen::Vector3d across_side(const SurfacePoint& point, int side, std::int32_t across);

}  // namespace supple::surface
