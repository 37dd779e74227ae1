#include "polygon_integrals.h"

#include <algorithm>
#include <cmath>

#include "planar_cross.h"
#include "quadrature.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;

/// Limits of a part of a side for one quadrature: the angle that it spans seen from the centre, in radians, and its
/// length relative to its distance from the centre.
constexpr double max_part_angle = 0.2;
constexpr double max_part_ratio = 0.4;
constexpr int max_side_halvings = 16;

/// The integral of |a + t (b - a)| over t in [0, 1]: the mean distance of a side from the centre, which is the origin.
double mean_distance(const Vector2d& a, const Vector2d& b) {
  const Vector2d side = b - a;
  const double squared = side.squaredNorm();
  if (squared == 0) return a.norm();
  const double length = std::sqrt(squared);
  const double height = std::abs(cross(a, side)) / length;
  const double begin = a.dot(side) / length;
  const double end = b.dot(side) / length;
  const double linear_term = end * b.norm() - begin * a.norm();
  // The logarithmic term vanishes with the height, where the side points at the centre.
  const double log_term = height > 0 ? height * height * (std::asinh(end / height) - std::asinh(begin / height)) : 0;
  return 0.5 * (linear_term + log_term) / length;
}

}  // namespace

PolygonIntegrals polygon_integrals(std::span<const Vector2d> corners, const Vector2d& centre) {
  PolygonIntegrals result;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    // Sum over the signed triangles of the centre and each side.
    const Vector2d a = corners[i] - centre;
    const Vector2d b = corners[i + 1 < corners.size() ? i + 1 : 0] - centre;
    const double twice_area = cross(a, b);
    result.area += 0.5 * twice_area;
    result.offset += twice_area / 6 * (a + b);
    result.square += twice_area / 12 * (a.squaredNorm() + a.dot(b) + b.squaredNorm());
    if (twice_area != 0) result.length += twice_area / 3 * mean_distance(a, b);
  }
  return result;
}

Vector2d stretched_offset(std::span<const Vector2d> corners, const Vector2d& centre, const Vector2d& zero, double first,
                          double stretch) {
  Vector2d result = Vector2d::Zero();
  // Adds the triangle of the centre and a side from a to b. Along a ray the integral of r * r dr is r^3 / 3. Along the
  // side, x = a + t (b - a), the angle grows by (a x b) / r^2 dt.
  const auto add = [&](const auto& self, const Vector2d& a, const Vector2d& b, int halvings) -> void {
    const double twice_area = cross(a, b);
    if (twice_area == 0) return;
    const double nearest = std::min(a.norm(), b.norm());
    if (halvings > 0 && (std::abs(twice_area) > max_part_angle * a.norm() * b.norm() || !(a.dot(b) > 0) ||
                         (b - a).norm() > max_part_ratio * nearest)) {
      const Vector2d middle = 0.5 * (a + b);
      self(self, a, middle, halvings - 1);
      return self(self, middle, b, halvings - 1);
    }
    for (std::size_t k = 0; k < five_nodes.size(); ++k) {
      const Vector2d place = a + five_nodes[k] * (b - a);
      const double angle = first + stretch * std::atan2(cross(zero, place), zero.dot(place));
      result += five_weights[k] * twice_area / 3 * place.norm() * Vector2d(std::cos(angle), std::sin(angle));
    }
  };
  for (std::size_t i = 0; i < corners.size(); ++i)
    add(add, corners[i] - centre, corners[i + 1 < corners.size() ? i + 1 : 0] - centre, max_side_halvings);
  return result;
}

void clip(std::span<const Vector2d> corners, const Vector2d& normal, double offset, Polygon& clipped) {
  clipped.clear();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector2d& a = corners[i];
    const Vector2d& b = corners[i + 1 < corners.size() ? i + 1 : 0];
    const double beyond_a = normal.dot(a) - offset;
    const double beyond_b = normal.dot(b) - offset;
    if (beyond_a <= 0) clipped.push_back(a);
    if ((beyond_a < 0 && beyond_b > 0) || (beyond_a > 0 && beyond_b < 0))
      clipped.push_back(a + beyond_a / (beyond_a - beyond_b) * (b - a));
  }
}

}  // namespace supple::voronoi
