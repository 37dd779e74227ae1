#include "square_family.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace supple::tiling {
namespace {

/// Length below which sides of the square family's tiles are points, in tiling units: some 1e-8 beam widths.
constexpr double min_tile_side = 1e-9;

// The polygon without vertices that coincide with the one before.
Polygon without_repetitions(const Polygon& polygon) {
  Polygon result;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Eigen::Vector2d& before = polygon[(k + polygon.size() - 1) % polygon.size()];
    if ((polygon[k] - before).norm() > min_tile_side) result.push_back(polygon[k]);
  }
  return result;
}

}  // namespace

Tiling square_in_square(double p) {
  // At |p| = 1 the square fills the cell, and the walls of neighbouring squares coincide. Beyond, nothing changes.
  const double a = std::min(std::abs(p), 1.0);
  Tiling tiling;
  tiling.lattice = 2 * Eigen::Matrix2d::Identity();
  const auto add = [&](const Polygon& tile, std::initializer_list<Placement> placements) {
    for (Placement placement : placements) {
      placement.tile = static_cast<int>(tiling.tiles.size());
      tiling.placements.push_back(placement);
    }
    tiling.tiles.push_back(tile);
  };
  if (2 * a > min_tile_side) add({{-a, -a}, {a, -a}, {a, a}, {-a, a}}, {{}});
  if (1 - a > min_tile_side) {
    // The first hexagon is the trapezoid above the inner square with its mirror image across the cell's upper side. The
    // second one is the first, rotated by -90 degrees.
    const Eigen::Matrix2d quarter_turn = (Eigen::Matrix2d() << 0, 1, -1, 0).finished();
    add(without_repetitions({{-1, 1}, {-a, a}, {a, a}, {1, 1}, {a, 2 - a}, {-a, 2 - a}}),
        {{}, {.linear = quarter_turn, .offset = {0, 0}}});
  }
  return tiling;
}

}  // namespace supple::tiling
