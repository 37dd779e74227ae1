#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <span>

namespace supple::surface {

/// The edges that a path crosses, as halfedges of the faces that it leaves. The strip of a path within one face is
/// empty. Paths through vertices, and across more than `capacity` edges, have no strip.
struct Strip {
  static constexpr int capacity = 15;
  std::int32_t count = -1;  ///< -1 if there is no strip
  std::array<std::int32_t, capacity> halfedges{};

  bool known() const { return count >= 0; }
  std::span<const std::int32_t> crossed() const {
    return {halfedges.data(), static_cast<std::size_t>(count > 0 ? count : 0)};
  }
};

/// A shortest path between two points, reduced to what forces at its ends need: its length, and the derivatives with
/// respect to the tangent coordinates of the ends, each in tangent_frame of its face.
struct TangentGeodesic {
  double distance = std::numeric_limits<double>::infinity();
  /// Lengths of the straight pieces at the ends. Each is the whole distance unless the path bends at a vertex in
  /// between.
  double first_length = 0;
  double last_length = 0;
  /// The unit directions of travel at the ends; zero if the ends are one point. The gradient of the distance is
  /// (-from_direction, to_direction).
  Eigen::Vector2d from_direction = Eigen::Vector2d::Zero();
  Eigen::Vector2d to_direction = Eigen::Vector2d::Zero();
  /// The angle at which the path leaves an end that lies on a vertex, measured as in VertexCone; NaN for other ends.
  double from_angle = std::numeric_limits<double>::quiet_NaN();
  double to_angle = std::numeric_limits<double>::quiet_NaN();
  /// If the ends coincide: the angle in radians that turns coordinates at the second end into those at the first.
  double turn = 0;
  bool pinned = false;  ///< whether the path bends at a vertex
  bool unique = true;   ///< see Geodesic::unique
  Strip strip{};

  bool coincident() const { return distance == 0; }
  /// The gradient with respect to the tangent coordinates of both ends. Coincident ends have none.
  Eigen::Vector4d gradient() const;
  /// The second derivatives [Thesis, eq. 3.9 to 3.11]. They vanish along the straight pieces at the ends. Coincident
  /// ends have none.
  Eigen::Matrix4d hessian() const;

  /// The path after its ends have moved by `step` (tangent coordinates of both) in the plane of the unfolded faces. It
  /// consists of the same straight pieces, and may no longer be the shortest path. The result is in the frames of the
  /// ends before the move. O(1).
  TangentGeodesic extrapolated(const Eigen::Vector4d& step) const;
  /// The same path in the coordinates before a move that turned the coordinates of the ends by these angles (radians).
  TangentGeodesic in_frames_before(double from_turn, double to_turn) const;
};

/// Counts of the methods by which the paths of many pairs were found.
struct PathCounts {
  std::int64_t same_face = 0;  ///< paths that are straight within a face
  std::int64_t unfolded = 0;   ///< paths straight within a strip, for which no path outside of the strip can be shorter
  std::int64_t searched = 0;   ///< paths that a search found

  PathCounts& operator+=(const PathCounts& other) {
    same_face += other.same_face;
    unfolded += other.unfolded;
    searched += other.searched;
    return *this;
  }
};

}  // namespace supple::surface
