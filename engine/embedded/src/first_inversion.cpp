#include "first_inversion.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace supple::embedded {
namespace {

/// Volume, as a ratio to that at the start, that counts as lost.
constexpr double lost_volume_ratio = 1e-12;
constexpr double root_tolerance = 1e-12;  ///< relative
/// Bisections of an interval after which its lower end is taken for the root.
constexpr int max_bisections = 1100;
/// Multiple of the step up to which roots are searched.
constexpr double max_step = 1e100;

/// 1 + a t + b t^2 + c t^3.
struct Cubic {
  double a;
  double b;
  double c;

  double operator()(double t) const { return 1 + t * (a + t * (b + t * c)); }

  /// A sufficient condition: the decreasing terms alone do not bring the cubic down to 0 before t.
  bool stays_positive(double t) const {
    return t * (std::max(0.0, -a) + t * (std::max(0.0, -b) + t * std::max(0.0, -c))) < 0.999;
  }

  /// The positive extrema in ascending order; a missing one is infinite.
  std::array<double, 2> extrema() const {
    constexpr double none = std::numeric_limits<double>::infinity();
    std::array<double, 2> at{none, none};
    const double discriminant = b * b - 3 * a * c;
    if (!(discriminant >= 0)) return at;
    const double q = -(b + std::copysign(std::sqrt(discriminant), b));
    at = {q / (3 * c), a / q};
    for (double& t : at)
      if (!(t > 0)) t = none;
    if (at[1] < at[0]) std::swap(at[0], at[1]);
    return at;
  }

  bool is_negative_at_infinity() const { return c != 0 ? c < 0 : b != 0 ? b < 0 : a < 0; }
};

/// The place where the cubic, which is monotone between `low` and `high`, falls to lost_volume_ratio.
double bisect(const Cubic& cubic, double low, double high) {
  for (int k = 0; k < max_bisections && high - low > root_tolerance * high; ++k) {
    const double midpoint = low + 0.5 * (high - low);
    (cubic(midpoint) > lost_volume_ratio ? low : high) = midpoint;
  }
  return low;
}

}  // namespace

double first_inversion(const Eigen::Matrix3d& edges, const Eigen::Matrix3d& change, double limit) {
  const Eigen::Vector3d across_edges = edges.col(1).cross(edges.col(2));
  const double volume = edges.col(0).dot(across_edges);
  if (!(volume > 0)) return 0;
  const Eigen::Vector3d across_change = change.col(1).cross(change.col(2));
  const Eigen::Vector3d mixed = edges.col(1).cross(change.col(2)) + change.col(1).cross(edges.col(2));
  const Cubic cubic{(change.col(0).dot(across_edges) + edges.col(0).dot(mixed)) / volume,
                    (edges.col(0).dot(across_change) + change.col(0).dot(mixed)) / volume,
                    change.col(0).dot(across_change) / volume};
  const double end = std::min(limit, max_step);
  if (cubic.stays_positive(end)) return std::numeric_limits<double>::infinity();
  double low = 0;
  for (const double extremum : cubic.extrema()) {
    if (!(extremum < end)) break;
    if (!(cubic(extremum) > lost_volume_ratio)) return bisect(cubic, low, extremum);
    low = extremum;
  }
  if (limit < max_step)
    return cubic(limit) > lost_volume_ratio ? std::numeric_limits<double>::infinity() : bisect(cubic, low, limit);
  if (!cubic.is_negative_at_infinity()) return std::numeric_limits<double>::infinity();
  double high = std::max(low, 1.0);
  while (cubic(high) > lost_volume_ratio) {
    low = high;
    high *= 2;
    if (high > max_step) return std::numeric_limits<double>::infinity();
  }
  return bisect(cubic, low, high);
}

}  // namespace supple::embedded
