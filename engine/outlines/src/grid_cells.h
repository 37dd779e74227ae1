#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "curve.h"
#include "supple/base/seeded_hash.h"

namespace supple::outlines {

/// A square of a grid over the plane. Each group of lines has a grid of its own.
struct GridCell {
  std::int64_t x = 0, y = 0;
  std::size_t group = 0;

  bool operator==(const GridCell&) const = default;

  struct Hash {
    std::size_t operator()(const GridCell& cell) const { return SeededHash::of(cell.x, cell.y, cell.group); }
  };
};

inline GridCell cell_of(const Point& p, double size, std::size_t group = 0) {
  return {static_cast<std::int64_t>(std::floor(p.x() / size)), static_cast<std::int64_t>(std::floor(p.y() / size)),
          group};
}

/// Calls visit(cell) for the cells within `distance` of a point until one call returns true, and returns whether one
/// did. There are one to four such cells if they are larger than twice the distance.
template <class Visit>
bool any_cell_near(const Point& p, double distance, double size, const Visit& visit, std::size_t group = 0) {
  const Point reach = Point::Constant(distance);
  const GridCell lower = cell_of(p - reach, size, group), upper = cell_of(p + reach, size, group);
  for (std::int64_t x = lower.x; x <= upper.x; ++x) {
    for (std::int64_t y = lower.y; y <= upper.y; ++y) {
      if (visit(GridCell{x, y, group})) return true;
    }
  }
  return false;
}

}  // namespace supple::outlines
