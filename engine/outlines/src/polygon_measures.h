#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "curve.h"
#include "supple/base/execution.h"

namespace supple::outlines {

struct Box {
  Point lower = Point::Constant(INFINITY), upper = Point::Constant(-INFINITY);
  void include(const Points& points) {
    for (const Point& p : points) {
      lower = lower.cwiseMin(p);
      upper = upper.cwiseMax(p);
    }
  }
  void include(const Box& box) {
    lower = lower.cwiseMin(box.lower);
    upper = upper.cwiseMax(box.upper);
  }
  bool contains(const Box& box) const {
    return (lower.array() <= box.lower.array()).all() && (upper.array() >= box.upper.array()).all();
  }
};
Box box_of(const Points& points);

/// The area of a polygon; positive if it runs counterclockwise. O(n).
double area_of(const Points& points);

/// Whether a point lies within a polygon, by the number of sides that a ray to its right crosses. O(n).
bool is_inside(const Points& polygon, const Point& p);

/// Whether every corner of each polyline lies within `distance` of the other one. O(n + m) if they run side by side,
/// O(n m) at worst. The ends of open polylines must lie within `distance` of each other, too.
bool is_same_curve(const Points& a, const Points& b, double distance, bool closed);

/// The polygon with fewer corners; those that are dropped lie within `distance` of its sides [Douglas1973]. O(n log n)
/// for most polygons, O(n^2) at worst.
Points simplified(const Points& polygon, double distance);

/// Drops corners that are not farther than `min_distance` from the one before.
void drop_repeated(Points& points, double min_distance);

/// Whether two sides of the polygon that are not neighbours cross or lie within `distance` of each other. About
/// O(n sqrt(n)) for n sides.
bool touches_itself(const Points& polygon, double distance, const Execution& execution);

/// The pairs i < j of polygons that have different owners and sides that cross or lie within `distance` of each other.
/// About O(n sqrt(n)) for n polygons, and the same for the n sides that lie where boxes of polygons overlap.
std::vector<std::pair<std::size_t, std::size_t>> contacts(const std::vector<const Points*>& polygons,
                                                          const std::vector<std::size_t>& owners, double distance,
                                                          const Execution& execution);

}  // namespace supple::outlines
