#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>

#include "planar_cross.h"

namespace supple::voronoi {

/// Places of a line as fractions of a way along it.
struct LineRoots {
  std::array<double, 2> fractions{};
  std::size_t count = 0;
};

/// Where |x - a| - |x - b| = c for x = from + fraction * way: the line's places on one branch of a hyperbola, on the
/// bisector of a and b for c = 0. In no order, not polished, and so exact to some 1e-8 of the fraction where roots lie
/// close together.
///
/// Squaring twice leaves a quadratic equation. Its discriminant is written as a sum, because the difference that one
/// writes first is lost in rounding where c is as small as that: no root would be found on a border that is all but a
/// bisector.
inline LineRoots equal_length_roots(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double c,
                                    const Eigen::Vector2d& from, const Eigen::Vector2d& way) {
  constexpr double rounding = 1e-14;
  const Eigen::Vector2d between = a - b;
  const Eigen::Vector2d to_b = b - from;
  // |x - a|^2 - |x - b|^2 - c^2 = p t + q, which is 2 c |x - b|.
  const double p = -2 * way.dot(between);
  const double q = between.dot(a - from + to_b) - c * c;
  LineRoots roots;
  if (c == 0) {
    if (p != 0) roots.fractions[roots.count++] = -q / p;
    return roots;
  }
  const double squared_way = way.squaredNorm();
  const double along = to_b.dot(way);
  const double across = cross(way, to_b);
  const double four = 4 * c * c;
  const double qa = p * p - four * squared_way;
  const double half = p * q + four * along;
  const double qc = q * q - four * to_b.squaredNorm();
  const double shifted = q * squared_way + along * p;
  const double square = (shifted * shifted + across * across * qa) / squared_way;
  if (!(square >= 0)) return roots;
  const double big = -(half + std::copysign(2 * std::abs(c) * std::sqrt(square), half));
  const auto offer = [&](double fraction) {
    // The other branch, where lengths differ by -c.
    const double lengths = p * fraction + q;
    if (std::copysign(1, c) * lengths < -rounding * (std::abs(p * fraction) + std::abs(q))) return;
    roots.fractions[roots.count++] = fraction;
  };
  if (qa != 0) offer(big / qa);
  if (big != 0) offer(qc / big);
  return roots;
}

}  // namespace supple::voronoi
