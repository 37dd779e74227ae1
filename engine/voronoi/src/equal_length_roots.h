#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>

#include "planar_cross.h"

namespace supple::voronoi {

/// Roots on a line x = from + fraction * direction, as fractions.
struct LineRoots {
  std::array<double, 2> fractions{};
  std::size_t count = 0;
};

/// The points of a line x = from + fraction * direction with |x - a| - |x - b| = c: its intersections with one branch
/// of a hyperbola, or with the bisector of a and b for c = 0. The roots are in no order. They are accurate to about
/// 1e-8 of the fraction where they lie close together.
///
/// Squaring twice gives a quadratic equation. Its discriminant is computed as a sum. The usual difference of products
/// cancels if c is small, and no root would be found on a border that is nearly a bisector.
inline LineRoots equal_length_roots(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double c,
                                    const Eigen::Vector2d& from, const Eigen::Vector2d& direction) {
  constexpr double rounding = 1e-14;
  const Eigen::Vector2d between = a - b;
  const Eigen::Vector2d to_b = b - from;
  // |x - a|^2 - |x - b|^2 - c^2 = p t + q, which equals 2 c |x - b|, t: fraction
  const double p = -2 * direction.dot(between);
  const double q = between.dot(a - from + to_b) - c * c;
  LineRoots roots;
  if (c == 0) {
    if (p != 0) roots.fractions[roots.count++] = -q / p;
    return roots;
  }
  const double squared_direction = direction.squaredNorm();
  const double along = to_b.dot(direction);
  const double across = cross(direction, to_b);
  const double four = 4 * c * c;
  const double qa = p * p - four * squared_direction;
  const double half = p * q + four * along;
  const double qc = q * q - four * to_b.squaredNorm();
  const double shifted = q * squared_direction + along * p;
  const double square = (shifted * shifted + across * across * qa) / squared_direction;
  if (!(square >= 0)) return roots;
  const double stable_sum = -(half + std::copysign(2 * std::abs(c) * std::sqrt(square), half));
  const auto add_root = [&](double fraction) {
    // On the other branch, where |x - a| - |x - b| = -c, p t + q has the sign of -c.
    const double branch_value = p * fraction + q;
    if (std::copysign(1, c) * branch_value < -rounding * (std::abs(p * fraction) + std::abs(q))) return;
    roots.fractions[roots.count++] = fraction;
  };
  if (qa != 0) add_root(stable_sum / qa);
  if (stable_sum != 0) add_root(qc / stable_sum);
  return roots;
}

}  // namespace supple::voronoi
