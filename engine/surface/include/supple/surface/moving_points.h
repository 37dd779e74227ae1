#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "supple/surface/retraction.h"

namespace supple::surface {

/// Points that move on a surface, two tangent coordinates each: of tangent_frame of the point's face or, on the tip of
/// a cone (a vertex), of cone_coordinates. The part of a numerics::State that is made of such points.
class MovingPoints {
 public:
  MovingPoints() = default;
  MovingPoints(const TriangleMesh& mesh, std::vector<SurfacePoint> points);

  const std::vector<SurfacePoint>& points() const { return points_; }
  bool on_tip(std::size_t point) const { return on_tip_[point] != 0; }
  /// The vertex that a point on a tip is at.
  std::int32_t vertex_of(const TriangleMesh& mesh, std::size_t point) const;

  /// Radians by which the last way turned a point's coordinates; 0 where it was no isometry.
  double turn(std::size_t point) const { return turns_[point]; }

  Eigen::Index dimension() const { return 2 * static_cast<Eigen::Index>(points_.size()); }
  /// Each point walks its own straightest path, and is stopped by a boundary by itself; in parallel. `step` has
  /// dimension() entries or more, of which the first are the points'. Returns what was travelled.
  Eigen::VectorXd move(const TriangleMesh& mesh, const Eigen::VectorXd& step);
  /// Turns each point's part of a tangent vector as its last way turned it. The way to or from a tip has no transport:
  /// there coordinates stay, which is an isometry too, and one point at a vertex does not make the others forget their
  /// curvature.
  void transport(Eigen::VectorXd& tangent) const;

  /// One point is elsewhere.
  void place(const TriangleMesh& mesh, std::size_t point, const SurfacePoint& at);
  /// The surface has moved under the points: which of them are on tips may have changed.
  void look_at(const TriangleMesh& mesh);

 private:
  std::vector<SurfacePoint> points_;
  std::vector<std::uint8_t> on_tip_;
  std::vector<double> turns_;  ///< of each point's coordinates along the last move
};

}  // namespace supple::surface
