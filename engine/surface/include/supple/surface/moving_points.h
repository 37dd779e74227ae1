#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "supple/surface/retraction.h"

namespace supple::surface {

/// Points that move on a surface, as a part of a numerics::State. Each point has two tangent coordinates. They refer to
/// tangent_frame of the point's face or, at the tip of a cone (a vertex), to cone_coordinates.
class MovingPoints {
 public:
  MovingPoints() = default;
  MovingPoints(const TriangleMesh& mesh, std::vector<SurfacePoint> points);

  /// Sets the token that moves check.
  void stop_with(const CancellationToken& cancellation) { cancellation_ = cancellation; }
  const CancellationToken& cancellation() const { return cancellation_; }

  const std::vector<SurfacePoint>& points() const { return points_; }
  bool on_tip(std::size_t point) const { return on_tip_[point] != 0; }
  /// The vertex at which a point on a tip lies.
  std::int32_t vertex_of(const TriangleMesh& mesh, std::size_t point) const;

  /// The angle in radians by which the last move turned a point's coordinates; 0 if the move was no isometry.
  double turn(std::size_t point) const { return turns_[point]; }

  Eigen::Index dimension() const { return 2 * static_cast<Eigen::Index>(points_.size()); }
  /// Moves each point along its own straightest geodesic, in parallel. A boundary stops only the point that meets it.
  /// `step` has at least dimension() entries, of which the first belong to the points. Returns the step that was
  /// travelled. Throws what exponential_map throws; some points have moved then.
  Eigen::VectorXd move(const TriangleMesh& mesh, const Eigen::VectorXd& step);
  /// Turns each point's part of a tangent vector by the angle by which its last move turned the coordinates. A move
  /// from or to a tip has no transport. There the coordinates stay as they are, which is an isometry too, so that a
  /// point at a vertex does not make the minimizer discard the curvature of the others.
  void transport(Eigen::VectorXd& tangent) const;

  /// Sets one point.
  void place(const TriangleMesh& mesh, std::size_t point, const SurfacePoint& at);
  /// Must be called after the surface has moved under the points: determines again which of them are on tips.
  void look_at(const TriangleMesh& mesh);

 private:
  CancellationToken cancellation_;
  std::vector<SurfacePoint> points_;
  std::vector<std::uint8_t> on_tip_;
  std::vector<double> turns_;  ///< angle (radians) by which the last move turned each point's coordinates
};

}  // namespace supple::surface
