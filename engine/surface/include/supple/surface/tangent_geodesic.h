#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <span>

namespace supple::surface {

/// The edges that a path crosses, as the halfedges of the faces that it leaves; empty for a path within a face. Paths
/// across more edges, or through vertices, have none.
struct Strip {
  static constexpr int capacity = 15;
  std::int32_t count = -1;  ///< -1 where there is no strip
  std::array<std::int32_t, capacity> halfedges{};

  bool known() const { return count >= 0; }
  std::span<const std::int32_t> crossed() const {
    return {halfedges.data(), static_cast<std::size_t>(count > 0 ? count : 0)};
  }
};

/// A shortest path between two points as what pulls at its ends: its length with the derivatives by tangent coordinates
/// of the ends, each in tangent_frame of its face, and nothing else.
struct TangentGeodesic {
  double distance = std::numeric_limits<double>::infinity();
  /// Of the straight pieces at the ends: the whole distance unless a vertex holds the path in between.
  double first_length = 0;
  double last_length = 0;
  /// Unit directions of travel at the ends; zero where these are one point. The distance's gradient is
  /// (-from_direction, to_direction).
  Eigen::Vector2d from_direction = Eigen::Vector2d::Zero();
  Eigen::Vector2d to_direction = Eigen::Vector2d::Zero();
  /// Of an end on a vertex: the angle under which the path leaves, as VertexCone counts it; NaN elsewhere.
  double from_angle = std::numeric_limits<double>::quiet_NaN();
  double to_angle = std::numeric_limits<double>::quiet_NaN();
  /// Of ends in one place: what turns coordinates at the second into coordinates at the first, in radians.
  double turn = 0;
  bool pinned = false;  ///< a vertex holds the path
  bool unique = true;   ///< see Geodesic::unique
  Strip strip{};

  bool coincident() const { return distance == 0; }
  /// By the tangent coordinates of both ends. Not for coincident ends.
  Eigen::Vector4d gradient() const;
  /// Second derivatives (thesis eq. 3.9 to 3.11): a straight piece resists only turning. Not for coincident ends.
  Eigen::Matrix4d hessian() const;

  /// The same straight pieces between ends that have moved by `step` (tangent coordinates of both) in the plane of the
  /// unfolded faces, whether or not that is still the shortest path. In the frames of the ends before. O(1).
  TangentGeodesic continued(const Eigen::Vector4d& step) const;
  /// The same by the coordinates that ends had before a way that turned these by so many radians.
  TangentGeodesic before_turns(double from_turn, double to_turn) const;
};

/// How the paths of many pairs were found.
struct PathsFound {
  std::int64_t same_face = 0;  ///< straight within a face
  std::int64_t unfolded = 0;   ///< straight within a strip, and no path that leaves it can be shorter
  std::int64_t searched = 0;

  PathsFound& operator+=(const PathsFound& other) {
    same_face += other.same_face;
    unfolded += other.unfolded;
    searched += other.searched;
    return *this;
  }
};

}  // namespace supple::surface
