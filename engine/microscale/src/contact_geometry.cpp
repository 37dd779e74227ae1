#include "contact_geometry.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace supple::microscale {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a[0] * b[1] - a[1] * b[0]; }

/// Conservative advancement ends when less than this fraction of the allowed approach is left.
constexpr double advancement_tolerance = 0.02;
/// Every iteration gives a step without contact, so that a limit of the iterations only shortens the step.
constexpr int max_advancement_iterations = 40;

/// The unit vector from a segment's nearest point to the origin, and the distance between the two.
struct Separation {
  Separation(const Eigen::Vector2d& tail, const Eigen::Vector2d& head) {
    const PointSegmentDistance found = point_segment_distance(tail, head);
    if (found.nearest == Nearest::inside) {
      const Eigen::Vector2d along = (head - tail).normalized();
      const double side = cross(tail, along);
      distance = std::abs(side);
      // The normal of the segment that points to the origin. If the origin lies on the segment, either normal will do.
      direction = side > 0 ? Eigen::Vector2d(-along[1], along[0]) : Eigen::Vector2d(along[1], -along[0]);
    } else {
      const Eigen::Vector2d& end = found.nearest == Nearest::tail ? tail : head;
      distance = std::sqrt(found.squared_distance);
      direction = distance > 0 ? Eigen::Vector2d(-end / distance) : Eigen::Vector2d::UnitX();
    }
  }
  Eigen::Vector2d direction;
  double distance = 0;
};

}  // namespace

// This function is not inlined, so that pairs and joints get bitwise the same result for the same segment.
[[gnu::noinline]] PointSegmentDistance point_segment_distance(const Eigen::Vector2d& tail,
                                                              const Eigen::Vector2d& head) {
  const Eigen::Vector2d side = head - tail;
  const double along = -tail.dot(side);
  if (along <= 0) return {Nearest::tail, tail.squaredNorm()};
  const double squared_length = side.squaredNorm();
  if (along >= squared_length) return {Nearest::head, head.squaredNorm()};
  const double area = cross(tail, side);
  return {Nearest::inside, area * area / squared_length};
}

InsideDistance::InsideDistance(const Eigen::Vector2d& tail, const Eigen::Vector2d& head) {
  const Eigen::Vector2d side = head - tail;
  length = side.norm();
  along = side / length;
  lambda = -tail.dot(along) / length;
  const Separation separation(tail, head);
  distance = separation.distance;
  normal = separation.direction;
}

InsideDistance::Vector6 InsideDistance::stack(const Eigen::Vector2d& v, double point, double tail, double head) {
  Vector6 stacked;
  stacked << point * v, tail * v, head * v;
  return stacked;
}

InsideDistance::Matrix6 InsideDistance::hessian(double first, double second, bool convex) const {
  // The Hessian is a 3 x 3 matrix in an orthonormal basis: alpha / |alpha|, the normalized part of d' orthogonal to
  // alpha, and beta / |beta|.
  const double skew = 1 - 2 * lambda;
  const double beta_norm = std::sqrt(1 + lambda * lambda + (1 - lambda) * (1 - lambda));
  const double alpha_norm = std::sqrt(2.0);
  const double across_norm = std::sqrt(1.5);
  Eigen::Matrix<double, 6, 3> basis;
  basis.col(0) = stack(normal, 0, -1, 1) / alpha_norm;
  basis.col(1) = stack(normal, 1, -0.5, -0.5) / across_norm;
  basis.col(2) = stack(along, 1, lambda - 1, -lambda) / beta_norm;

  const Eigen::Vector3d slope(skew / alpha_norm, across_norm, 0);
  Eigen::Matrix3d local = second * slope * slope.transpose();
  local(0, 0) -= 2 * first * distance / (length * length);
  local(0, 2) -= first * alpha_norm * beta_norm / length;
  local(2, 0) = local(0, 2);
  if (convex) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> modes(local);
    local = modes.eigenvectors() * modes.eigenvalues().cwiseMax(0).asDiagonal() * modes.eigenvectors().transpose();
  }
  return basis * local * basis.transpose();
}

LogBarrier::LogBarrier(double distance, double range) {
  const double ratio = distance / range;
  const double log = std::log(ratio);
  const double gap = ratio - 1;
  value = -range * gap * gap * log / 2;
  first = -gap * log - gap * gap / (2 * ratio);
  second = (-log - 2 * gap / ratio + gap * gap / (2 * ratio * ratio)) / range;
}

double conservative_ccd_step(const Eigen::Vector2d& tail, const Eigen::Vector2d& head,
                             const Eigen::Vector2d& tail_change, const Eigen::Vector2d& head_change, double min_ratio,
                             double limit) {
  double step = 0;
  double min_distance = 0;
  double end_distance = 0;
  for (int iteration = 0; iteration < max_advancement_iterations; ++iteration) {
    const Eigen::Vector2d tail_now = tail + step * tail_change;
    const Eigen::Vector2d head_now = head + step * head_change;
    const Separation separation(tail_now, head_now);
    if (iteration == 0) {
      min_distance = min_ratio * separation.distance;
      end_distance = min_distance + advancement_tolerance * (separation.distance - min_distance);
    } else if (separation.distance <= end_distance) {
      break;
    }
    double advance = limit - step;
    const auto bound = [&](const Eigen::Vector2d& end, const Eigen::Vector2d& change) {
      const double approach = separation.direction.dot(change);
      const double allowed = -separation.direction.dot(end) - min_distance;
      if (approach * advance > allowed) advance = std::max(allowed, 0.0) / approach;
    };
    bound(tail_now, tail_change);
    bound(head_now, head_change);
    step += advance;
    if (step >= limit) return limit;
  }
  return step;
}

bool stays_beyond(const Eigen::Vector2d& tail, const Eigen::Vector2d& head, const Eigen::Vector2d& tail_change,
                  const Eigen::Vector2d& head_change, double distance) {
  const Separation separation(tail, head);
  return separation.distance > distance && -separation.direction.dot(tail + tail_change) > distance &&
         -separation.direction.dot(head + head_change) > distance;
}

bool segments_cross(const Eigen::Vector2d& tail, const Eigen::Vector2d& head, const Eigen::Vector2d& other_tail,
                    const Eigen::Vector2d& other_head) {
  // The bounding boxes tell collinear segments apart. For those, rounding alone decides the signs of the products
  // below.
  const Eigen::Vector2d low = tail.cwiseMin(head).cwiseMax(other_tail.cwiseMin(other_head));
  const Eigen::Vector2d high = tail.cwiseMax(head).cwiseMin(other_tail.cwiseMax(other_head));
  if ((low.array() > high.array()).any()) return false;
  const auto side_of = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& p) {
    return cross(b - a, p - a);
  };
  return side_of(tail, head, other_tail) * side_of(tail, head, other_head) < 0 &&
         side_of(other_tail, other_head, tail) * side_of(other_tail, other_head, head) < 0;
}

}  // namespace supple::microscale
