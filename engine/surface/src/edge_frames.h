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

/// Whether a vertex can bend a shortest path: a saddle vertex or one of the boundary.
bool bends_paths(const TriangleMesh& mesh, std::int32_t v);

/// What window propagation reads of one halfedge h: its face laid into the plane with the tail at the origin, the head
/// on the positive x axis and the apex above, and where windows go from here. One cache line.
struct alignas(64) EdgeFrame {
  double length;
  double apex_offset;  ///< along h from one of its ends to the apex: from the end that gives the smaller number
  double apex_y;
  double left_length;   ///< of the edge tail - apex
  double right_length;  ///< of the edge apex - head
  std::int32_t left;    ///< twin of previous(h), from tail to apex in the next face; -1 on the boundary
  std::int32_t right;   ///< twin of next(h), from apex to head in the next face; -1 on the boundary
  std::int32_t tail, head, apex;
  std::int32_t offset_from_head;  ///< 1 if apex_offset counts from the head, else 0

  double apex_x() const { return (offset_from_head ? length : 0) + apex_offset; }
  /// length - apex_x without cancellation. Divided by right_length it is the right edge's direction, which a difference
  /// of lengths loses where that edge is short.
  double right_x() const { return (offset_from_head ? 0 : length) - apex_offset; }

  /// Unit directions of the halfedges `left` and `right`, in the frame of each of them (ux, uy) as windows that go on
  /// to them are turned by.
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

/// A corner of a vertex's fan of faces.
struct FanCorner {
  double polar_angle;     ///< sum of the corner angles that come before, from TriangleMesh::outgoing
  double angle;           ///< of this corner
  std::int32_t halfedge;  ///< outgoing
  std::int32_t across;  ///< twin of the side opposite the vertex: where windows from the vertex go; -1 on the boundary
};

/// A vertex that is closer than this to another, relative to the sides of a face of both, is seen from there in a
/// direction that has lost more digits than the tolerances allow for.
inline constexpr double kShortSide = 1e-4;

/// The mesh as the searches see it.
struct SearchMesh {
  explicit SearchMesh(std::shared_ptr<const TriangleMesh> mesh, const Execution& execution = {});

  /// bends_paths, looked up.
  bool pins(std::int32_t vertex) const { return pins_paths[vertex] != 0; }

  /// Radians that the angle around a vertex is stretched to where points around it are images in the plane: half a turn
  /// at a boundary, whose two sides stay apart that way.
  double turn_of_images(std::int32_t vertex) const {
    return mesh->is_boundary(vertex) ? std::numbers::pi : 2 * std::numbers::pi;
  }

  /// Without the mesh.
  std::size_t memory_bytes() const;

  std::shared_ptr<const TriangleMesh> mesh;
  std::vector<EdgeFrame> frames;
  std::vector<std::uint8_t> pins_paths;
  double longest_edge = 0;
  bool has_needles = false;  ///< a face has a side below kShortSide of another
  std::span<const FanCorner> fan(std::int32_t vertex) const {
    return {corners.data() + first_corner[vertex], corners.data() + first_corner[vertex + 1]};
  }
  /// Polar angle around its tail of an outgoing halfedge.
  double polar_angle(std::int32_t h) const {
    for (const FanCorner& corner : fan(frames[h].tail)) {
      if (corner.halfedge == h) return corner.polar_angle;
    }
    return 0;
  }

  /// The fans of all vertices, counterclockwise, each in one piece of memory.
  std::vector<FanCorner> corners;
  std::vector<std::int32_t> first_corner;
};

/// Planar coordinates, in the frame of halfedge 3 f + side, of the point of face f with the given barycentrics.
Eigen::Vector2d planar_point(const EdgeFrame& frame, const Eigen::Vector3d& barycentric, int side);

/// Barycentric coordinates of a point of a side in the face beyond, whose halfedge there is `across`: the ends swap.
Eigen::Vector3d across_side(const SurfacePoint& point, int side, std::int32_t across);

}  // namespace supple::surface
