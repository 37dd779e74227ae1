#pragma once

#include <Eigen/Core>

namespace supple::microscale {

/// Where on a segment the point nearest to a given point lies.
enum class Nearest { tail, inside, head };

/// What a point at the origin sees of a segment. A segment without length counts as its tail.
struct SegmentView {
  Nearest nearest = Nearest::tail;
  double squared_distance = 0;
};
SegmentView view_segment(const Eigen::Vector2d& tail, const Eigen::Vector2d& head);

/// Distance of a point at the origin from a segment, with derivatives.
///
/// Inside: let n be the unit vector from the segment to the point, t that along the segment, L its length, lambda the
/// nearest point's share of it. Then with the stacked (point, tail, head)
///   d' = n (x) (1, lambda - 1, -lambda),   d'' = -(alpha beta^T + beta alpha^T) / L - d alpha alpha^T / L^2,
///   alpha = n (x) (0, -1, 1),   beta = t (x) (1, lambda - 1, -lambda).
/// `outer` (first) and `inner` (second derivative of a function of d) make the Hessian of that function.
struct InsideDistance {
  InsideDistance(const Eigen::Vector2d& tail, const Eigen::Vector2d& head);

  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  Vector6 gradient() const { return stack(normal, 1, lambda - 1, -lambda); }
  /// Hessian of f(d) for f' = first, f'' = second; only its positive semidefinite part where `convex`.
  Matrix6 hessian(double first, double second, bool convex) const;

  double distance = 0;
  double length = 0;
  double lambda = 0;
  Eigen::Vector2d normal;
  Eigen::Vector2d along;

 private:
  static Vector6 stack(const Eigen::Vector2d& v, double point, double tail, double head);
};

/// b(d; r) = -(d - r)^2 ln(d / r) / (2 r) for 0 < d < r, and its derivatives by d.
struct LogBarrier {
  LogBarrier(double distance, double range);
  double value;   ///< mm
  double first;   ///< 1
  double second;  ///< 1/mm
};

/// The largest t <= limit, found conservatively, such that the distance of a point at the origin from the segment
/// (tail + s tail_change, head + s head_change) stays at least `kept` times its value at s = 0 for all s in [0, t].
/// Positive wherever that distance and limit are.
///
/// Conservative advancement: with n the direction of the distance at some s, the distance at a later s is at least
/// the least distance of the two ends along n, which changes linearly. Sliding along the segment costs nothing.
double safe_share(const Eigen::Vector2d& tail, const Eigen::Vector2d& head, const Eigen::Vector2d& tail_change,
                  const Eigen::Vector2d& head_change, double kept, double limit);

/// Whether a segment stays farther than `distance` from a point at the origin while both its ends move straight; false
/// also where that is not certain.
bool stays_beyond(const Eigen::Vector2d& tail, const Eigen::Vector2d& head, const Eigen::Vector2d& tail_change,
                  const Eigen::Vector2d& head_change, double distance);

/// Whether two segments cross each other in a point inside both.
bool segments_cross(const Eigen::Vector2d& tail, const Eigen::Vector2d& head, const Eigen::Vector2d& other_tail,
                    const Eigen::Vector2d& other_head);

}  // namespace supple::microscale
