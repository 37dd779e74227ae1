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

/// Of a polygon; positive if it runs counterclockwise. O(n).
double area_of(const Points& points);

/// Whether a point lies within a polygon, by the number of sides to its right. O(n).
bool is_inside(const Points& polygon, const Point& p);

/// Whether no corner of either polyline is farther than `distance` from the other one. O(n m), less where they run side
/// by side; at once if their boxes differ, or their ends do where they are not closed.
bool is_same_curve(const Points& a, const Points& b, double distance, bool closed);

/// A polygon of some of the corners, from whose sides no corner is farther than `distance` (Douglas and Peucker, 1973).
/// O(n log n) for most polygons, O(n^2) at worst.
Points simplified(const Points& polygon, double distance);

/// Drops corners that are not farther than `least` from the one before.
void drop_repeated(Points& points, double least);

/// Whether sides of the polygon that are not neighbours cross, or come as near to each other as `distance`. About
/// O(n sqrt(n)) for n sides.
bool touches_itself(const Points& polygon, double distance, const Execution& execution);

/// The pairs of polygons i < j of different owners of which sides cross, or come as near to each other as `distance`.
/// About O(n sqrt(n)) for n polygons, and as much for those of their sides that lie where boxes of polygons overlap.
std::vector<std::pair<std::size_t, std::size_t>> contacts(const std::vector<const Points*>& polygons,
                                                          const std::vector<std::size_t>& owners, double distance,
                                                          const Execution& execution);

}  // namespace supple::outlines
