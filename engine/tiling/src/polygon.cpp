#include "polygon.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace supple::tiling {
namespace {

/// Sides closer than this fraction of the perimeter touch: far above rounding, far below any beam's width.
constexpr double contact_fraction = 1e-9;

bool properly_cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                    const Eigen::Vector2d& d) {
  return cross(b - a, c - a) * cross(b - a, d - a) < 0 && cross(d - c, a - c) * cross(d - c, b - c) < 0;
}

double segment_distance(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                        const Eigen::Vector2d& d) {
  if (properly_cross(a, b, c, d)) return 0;
  return std::min({distance_to_segment(a, c, d), distance_to_segment(b, c, d), distance_to_segment(c, a, b),
                   distance_to_segment(d, a, b)});
}

}  // namespace

Eigen::Vector2d nearest_on_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d u = b - a;
  const double squared = u.squaredNorm();
  const double t = squared > 0 ? std::clamp((p - a).dot(u) / squared, 0.0, 1.0) : 0.0;
  return a + t * u;
}

double distance_to_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return (p - nearest_on_segment(p, a, b)).norm();
}

double area(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    // Vectors are relative to the first vertex, so that no digits are lost far from the origin.
    twice += cross(polygon[k] - polygon[0], polygon[(k + 1) % polygon.size()] - polygon[0]);
  }
  return twice / 2;
}

double perimeter(const Polygon& polygon) {
  double length = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) length += (polygon[(k + 1) % polygon.size()] - polygon[k]).norm();
  return length;
}

Eigen::Vector2d centroid(const Polygon& polygon) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double twice = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Eigen::Vector2d a = polygon[k] - polygon[0], b = polygon[(k + 1) % polygon.size()] - polygon[0];
    sum += cross(a, b) * (a + b) / 3;
    twice += cross(a, b);
  }
  return polygon[0] + sum / twice;
}

int winding_number(const Polygon& polygon, const Eigen::Vector2d& point) {
  int winding = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Eigen::Vector2d a = polygon[k] - point, b = polygon[(k + 1) % polygon.size()] - point;
    if ((a.y() <= 0) == (b.y() <= 0)) continue;
    if ((cross(a, b) > 0) == (b.y() > 0)) winding += b.y() > 0 ? 1 : -1;
  }
  return winding;
}

std::optional<std::pair<int, int>> self_intersection(const Polygon& polygon) {
  const int n = static_cast<int>(polygon.size());
  const double tolerance = contact_fraction * perimeter(polygon);
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[(i + 1) % n], &after = polygon[(i + 2) % n];
    // Neighbours share b. They fold back if the far end of one lies on the other.
    if ((b - a).norm() <= tolerance || distance_to_segment(a, b, after) <= tolerance ||
        distance_to_segment(after, a, b) <= tolerance) {
      return std::pair(i, (i + 1) % n);
    }
    for (int j = i + 2; j < n; ++j) {
      if ((j + 1) % n == i) continue;
      if (segment_distance(a, b, polygon[j], polygon[(j + 1) % n]) <= tolerance) return std::pair(i, j);
    }
  }
  return std::nullopt;
}

double outline_distance(const Polygon& a, const Polygon& b) {
  double smallest = INFINITY;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      smallest = std::min(smallest, segment_distance(a[i], a[(i + 1) % a.size()], b[j], b[(j + 1) % b.size()]));
    }
  }
  return smallest;
}

void Bounds::include(const Polygon& polygon) {
  for (const Eigen::Vector2d& p : polygon) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
}

bool Bounds::contain(const Bounds& other) const {
  return (other.lower - lower).minCoeff() > 0 && (upper - other.upper).minCoeff() > 0;
}

bool Bounds::meet(const Bounds& other, double margin) const {
  return (lower.array() <= other.upper.array() + margin).all() && (upper.array() >= other.lower.array() - margin).all();
}

Bounds bounds_of(std::span<const Polygon> polygons) {
  Bounds bounds;
  for (const Polygon& polygon : polygons) bounds.include(polygon);
  return bounds;
}

Polygon moved(Polygon polygon, const Eigen::Vector2d& translation) {
  for (Eigen::Vector2d& p : polygon) p += translation;
  return polygon;
}

Polygon placed(const Polygon& polygon, const Placement& placement) {
  Polygon result;
  result.reserve(polygon.size());
  for (const Eigen::Vector2d& vertex : polygon) result.emplace_back(placement.linear * vertex + placement.offset);
  if (placement.linear.determinant() < 0) std::reverse(result.begin(), result.end());
  return result;
}

}  // namespace supple::tiling
