#include "polygon_integrals.h"

#include <algorithm>
#include <cmath>

#include "planar_cross.h"
#include "quadrature.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;

/// Radians of a side, seen from the centre, that one quadrature takes, and how long it may be for its distance.
constexpr double widest_part = 0.2;
constexpr double longest_part = 0.4;
constexpr int most_side_halvings = 16;

/// The integral of |a + t (b - a)| over t in [0, 1], which is the mean distance of a side from the centre.
double mean_length(const Vector2d& a, const Vector2d& b) {
  const Vector2d side = b - a;
  const double squared = side.squaredNorm();
  if (squared == 0) return a.norm();
  const double length = std::sqrt(squared);
  const double height = std::abs(cross(a, side)) / length;
  const double begin = a.dot(side) / length;
  const double end = b.dot(side) / length;
  const double straight = end * b.norm() - begin * a.norm();
  // The logarithm belongs to the height; where the side points at the centre there is none.
  const double bent = height > 0 ? height * height * (std::asinh(end / height) - std::asinh(begin / height)) : 0;
  return 0.5 * (straight + bent) / length;
}

}  // namespace

PolygonIntegrals polygon_integrals(std::span<const Vector2d> corners, const Vector2d& centre) {
  PolygonIntegrals result;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    // Signed triangles of the centre and each side.
    const Vector2d a = corners[i] - centre;
    const Vector2d b = corners[i + 1 < corners.size() ? i + 1 : 0] - centre;
    const double doubled = cross(a, b);
    result.area += 0.5 * doubled;
    result.way += doubled / 6 * (a + b);
    result.square += doubled / 12 * (a.squaredNorm() + a.dot(b) + b.squaredNorm());
    if (doubled != 0) result.length += doubled / 3 * mean_length(a, b);
  }
  return result;
}

Vector2d stretched_way(std::span<const Vector2d> corners, const Vector2d& centre, const Vector2d& zero, double first,
                       double stretch) {
  Vector2d result = Vector2d::Zero();
  // The triangle of the centre and a side from a to b: of r dr the integral is r^3 / 3, and the angle grows by
  // (a x b) / r^2 dt along the side.
  const auto add = [&](const auto& self, const Vector2d& a, const Vector2d& b, int halvings) -> void {
    const double doubled = cross(a, b);
    if (doubled == 0) return;
    const double nearest = std::min(a.norm(), b.norm());
    if (halvings > 0 && (std::abs(doubled) > widest_part * a.norm() * b.norm() || !(a.dot(b) > 0) ||
                         (b - a).norm() > longest_part * nearest)) {
      const Vector2d middle = 0.5 * (a + b);
      self(self, a, middle, halvings - 1);
      return self(self, middle, b, halvings - 1);
    }
    for (std::size_t k = 0; k < five_nodes.size(); ++k) {
      const Vector2d at = a + five_nodes[k] * (b - a);
      const double turn = first + stretch * std::atan2(cross(zero, at), zero.dot(at));
      result += five_weights[k] * doubled / 3 * at.norm() * Vector2d(std::cos(turn), std::sin(turn));
    }
  };
  for (std::size_t i = 0; i < corners.size(); ++i)
    add(add, corners[i] - centre, corners[i + 1 < corners.size() ? i + 1 : 0] - centre, most_side_halvings);
  return result;
}

void clip(std::span<const Vector2d> corners, const Vector2d& normal, double offset, Polygon& kept) {
  kept.clear();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector2d& a = corners[i];
    const Vector2d& b = corners[i + 1 < corners.size() ? i + 1 : 0];
    const double beyond_a = normal.dot(a) - offset;
    const double beyond_b = normal.dot(b) - offset;
    if (beyond_a <= 0) kept.push_back(a);
    if ((beyond_a < 0 && beyond_b > 0) || (beyond_a > 0 && beyond_b < 0))
      kept.push_back(a + beyond_a / (beyond_a - beyond_b) * (b - a));
  }
}

}  // namespace supple::voronoi
