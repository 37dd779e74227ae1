#pragma once

#include <Eigen/Core>

namespace supple::microscale {

/// Where on a segment the point nearest to a given point lies.
enum class Nearest { tail, inside, head };

/// Distance of a point at the origin from a segment. The nearest point of a segment without length is its tail.
struct PointSegmentDistance {
  Nearest nearest = Nearest::tail;
  double squared_distance = 0;
};
PointSegmentDistance point_segment_distance(const Eigen::Vector2d& tail, const Eigen::Vector2d& head);

/// Distance d of a point at the origin from a segment, with derivatives. It must be the distance from a point inside
/// the segment (Nearest::inside).
///
/// Let n be the unit vector from the segment to the point, t the unit vector along the segment, L its length, and
/// lambda the nearest point's distance from the tail divided by L. With respect to the stacked coordinates of point,
/// tail and head,
///   d' = n (x) (1, lambda - 1, -lambda),   d'' = -(alpha beta^T + beta alpha^T) / L - d alpha alpha^T / L^2,
///   alpha = n (x) (0, -1, 1),   beta = t (x) (1, lambda - 1, -lambda).
struct InsideDistance {
  InsideDistance(const Eigen::Vector2d& tail, const Eigen::Vector2d& head);

  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  Vector6 gradient() const { return stack(normal, 1, lambda - 1, -lambda); }
  /// Hessian of a function f(d) with f' = first and f'' = second. If `convex`, only its positive semidefinite part.
  Matrix6 hessian(double first, double second, bool convex) const;

  double distance = 0;
  double length = 0;
  double lambda = 0;
  Eigen::Vector2d normal;
  Eigen::Vector2d along;

 private:
  static Vector6 stack(const Eigen::Vector2d& v, double point, double tail, double head);
};

/// b(d; r) = -(d - r)^2 ln(d / r) / (2 r) for 0 < d < r, and its derivatives with respect to d.
struct LogBarrier {
  LogBarrier(double distance, double range);
  double value;   ///< mm
  double first;   ///< b', dimensionless
  double second;  ///< b'', 1/mm
};

/// Conservative continuous collision detection: a t <= limit such that the distance of a point at the origin from the
/// segment (tail + s tail_change, head + s head_change) stays at least `min_ratio` times its value at s = 0 for all s
/// in [0, t]. It is a little less than the largest such t, and positive if the distance at s = 0 and `limit` are.
///
/// The method is conservative advancement. Let n be the unit vector between the nearest points at some s. The distance
/// at a later s is at least that of the nearer end along n, which changes linearly. A motion along the segment
/// therefore does not shorten the step.
double conservative_ccd_step(const Eigen::Vector2d& tail, const Eigen::Vector2d& head,
                             const Eigen::Vector2d& tail_change, const Eigen::Vector2d& head_change, double min_ratio,
                             double limit);

/// Returns true only if a segment stays farther than `distance` from a point at the origin while both its ends move on
/// straight lines. It may return false for a segment that does.
bool stays_beyond(const Eigen::Vector2d& tail, const Eigen::Vector2d& head, const Eigen::Vector2d& tail_change,
                  const Eigen::Vector2d& head_change, double distance);

/// Whether two segments cross each other at a point that is inside both.
bool segments_cross(const Eigen::Vector2d& tail, const Eigen::Vector2d& head, const Eigen::Vector2d& other_tail,
                    const Eigen::Vector2d& other_head);

}  // namespace supple::microscale
