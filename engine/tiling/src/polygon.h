#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "supple/tiling/family.h"

namespace supple::tiling {

inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// The area, positive for counterclockwise polygons.
double area(const Polygon& polygon);
double perimeter(const Polygon& polygon);

/// The centroid of the enclosed area, which must not vanish.
Eigen::Vector2d centroid(const Polygon& polygon);

/// How often the polygon winds around a point that does not lie on it; counterclockwise is positive.
int winding_number(const Polygon& polygon, const Eigen::Vector2d& point);

/// Two sides that meet elsewhere than neighbours do in their common vertex. There are such sides if the outline crosses
/// or touches itself, folds back or has a side of no length. "Touch" means within 1e-9 perimeters. Side k joins
/// vertices k and k + 1. Quadratic in the number of sides.
std::optional<std::pair<int, int>> self_intersection(const Polygon& polygon);

/// The point of the segment from a to b that is nearest to p, and its distance from p.
Eigen::Vector2d nearest_on_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b);
double distance_to_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b);

/// The smallest distance between two outlines.
double outline_distance(const Polygon& a, const Polygon& b);

/// The smallest box around polygons.
struct Bounds {
  Eigen::Vector2d lower = Eigen::Vector2d::Constant(INFINITY), upper = Eigen::Vector2d::Constant(-INFINITY);

  void include(const Polygon& polygon);
  /// Whether the other box lies within this one, without touching it.
  bool contain(const Bounds& other) const;
  /// Whether the boxes come within `margin` of each other.
  bool meet(const Bounds& other, double margin = 0) const;
  Eigen::Vector2d middle() const { return (lower + upper) / 2; }
};

Bounds bounds_of(std::span<const Polygon> polygons);
inline Bounds bounds_of(const Polygon& polygon) { return bounds_of(std::span(&polygon, 1)); }

/// The polygon, translated.
Polygon moved(Polygon polygon, const Eigen::Vector2d& translation);

/// The polygon at its placement. If this reflects, the vertices are reversed, so that they stay counterclockwise.
Polygon placed(const Polygon& polygon, const Placement& placement);

}  // namespace supple::tiling
