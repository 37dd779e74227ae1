#include "narrow_places.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "polygon.h"

namespace supple::tiling {
namespace {

/// Cosines below this are right angles, and the disk between two points may overlap the outline by this fraction of its
/// radius: both are rounding.
constexpr double right_angle = 1e-6;
/// Walls that approach or leave each other by less than this slope are parallel.
constexpr double parallel_slope = 1e-4;
/// Corners of two parallel walls within this fraction of their distance lie opposite each other.
constexpr double opposite = 1e-6;
/// Parallel walls are followed over so many corners at most, which are corners of no angle then.
constexpr int max_straight_corners = 100;
/// The first search looks for places up to so many usual widths, and each further one for so much wider ones.
constexpr double first_search = 2;
constexpr double wider_search = 8;
/// A grid has at most so many columns and rows.
constexpr double max_grid_lines = 4000;

struct Side {
  Eigen::Vector2d from, to;
  std::size_t previous = 0, next = 0;  ///< the neighbours in its polygon
};

/// Sides by the squares of a grid that they run through.
class SideGrid {
 public:
  SideGrid(const std::vector<Side>& sides, double square) : square_(square) {
    for (std::size_t i = 0; i < sides.size(); ++i) {
      const Eigen::Vector2d way = sides[i].to - sides[i].from;
      const auto pieces = static_cast<int>(way.norm() / square) + 1;
      for (int k = 0; k < pieces; ++k) {
        const Eigen::Vector2d p = sides[i].from + way * k / pieces, q = sides[i].from + way * (k + 1) / pieces;
        for_each_square(p.cwiseMin(q), p.cwiseMax(q), [&](std::uint64_t key) { entries_.emplace_back(key, i); });
      }
    }
    std::sort(entries_.begin(), entries_.end());
    entries_.erase(std::unique(entries_.begin(), entries_.end()), entries_.end());
    last_seen_.assign(sides.size(), 0);
  }

  /// Sides that may come within `radius` of the point, in their order in each square.
  const std::vector<std::size_t>& near(const Eigen::Vector2d& point, double radius, std::vector<std::size_t>& found) {
    found.clear();
    ++search_;
    const Eigen::Vector2d reach = Eigen::Vector2d::Constant(radius);
    for_each_square(point - reach, point + reach, [&](std::uint64_t key) {
      for (auto entry = std::lower_bound(entries_.begin(), entries_.end(), std::pair(key, std::size_t{0}));
           entry != entries_.end() && entry->first == key; ++entry) {
        if (last_seen_[entry->second] == search_) continue;
        last_seen_[entry->second] = search_;
        found.push_back(entry->second);
      }
    });
    return found;
  }

 private:
  template <class Visit>
  void for_each_square(const Eigen::Vector2d& lower, const Eigen::Vector2d& upper, const Visit& visit) const {
    // Coordinates of parts are within some metres, so that the numbers of squares are small.
    constexpr std::int64_t offset = std::int64_t{1} << 31;
    const auto number = [&](double coordinate) {
      return static_cast<std::int64_t>(std::floor(coordinate / square_)) + offset;
    };
    for (std::int64_t y = number(lower.y()); y <= number(upper.y()); ++y) {
      for (std::int64_t x = number(lower.x()); x <= number(upper.x()); ++x)
        visit((static_cast<std::uint64_t>(y) << 32U) | static_cast<std::uint64_t>(x));
    }
  }

  double square_;
  std::vector<std::pair<std::uint64_t, std::size_t>> entries_;
  std::vector<std::uint32_t> last_seen_;
  std::uint32_t search_ = 0;
};

/// A point of a side.
struct OutlinePoint {
  Eigen::Vector2d at;
  std::size_t side = 0;
  bool is_corner = false;  ///< the corner where the side begins
  bool is_end = false;     ///< the corner where it ends and the next one begins
};

class Search {
 public:
  explicit Search(const SolidFace& face) {
    for (const Polygon& polygon : face) {
      const std::size_t first = sides_.size(), n = polygon.size();
      bounds_.include(polygon);
      for (std::size_t k = 0; k < n; ++k) {
        sides_.push_back({polygon[k], polygon[(k + 1) % n], first + (k + n - 1) % n, first + (k + 1) % n});
      }
    }
  }

  double diameter() const { return (bounds_.upper - bounds_.lower).norm(); }

  /// All places narrower than `limit`, and the narrowest of the others up to the width `reach`.
  NarrowPlaces within(double limit, double reach) {
    SideGrid grid(sides_, std::max(reach, diameter() / max_grid_lines));
    NarrowPlaces found;
    double widest = reach;  // nothing wider is of interest
    std::vector<std::size_t> opposite_sides, around;
    for (std::size_t v = 0; v < sides_.size(); ++v) {
      if (!is_reentrant(v)) continue;
      const OutlinePoint corner{sides_[v].from, v, true, false};
      grid.near(corner.at, std::max(limit, widest), opposite_sides);
      for (const std::size_t side : opposite_sides) {
        if (side == v || side == sides_[v].previous) continue;
        const OutlinePoint facing = nearest_point(side, corner.at);
        const double width = (facing.at - corner.at).norm();
        if (!(width > 0) || (width >= limit && width >= widest) || !face_each_other(corner, facing)) continue;
        grid.near((corner.at + facing.at) / 2, width / 2, around);
        if (!holds_disk(corner.at, facing.at, around) || !widens_both_ways(corner, facing)) continue;
        if (width < limit) {
          found.below.push_back({corner.at, facing.at});
        } else {
          widest = width;
          found.least_of_rest = width;
        }
      }
    }
    return found;
  }

 private:
  Eigen::Vector2d direction(std::size_t side) const { return (sides_[side].to - sides_[side].from).normalized(); }

  /// Whether the solid fills more than half of the surroundings of the corner where the side begins.
  bool is_reentrant(std::size_t side) const {
    const Side& before = sides_[sides_[side].previous];
    return cross(before.to - before.from, sides_[side].to - sides_[side].from) < 0;
  }

  OutlinePoint nearest_point(std::size_t side, const Eigen::Vector2d& p) const {
    const Eigen::Vector2d way = sides_[side].to - sides_[side].from;
    const double t = std::clamp((p - sides_[side].from).dot(way) / way.squaredNorm(), 0.0, 1.0);
    return {sides_[side].from + t * way, side, t == 0, t == 1};
  }

  /// Whether the outline at either point leaves the disk between them free, and the solid lies between them.
  bool face_each_other(const OutlinePoint& corner, const OutlinePoint& facing) const {
    const Eigen::Vector2d across = (facing.at - corner.at).normalized();
    if (!leaves_free(corner.side, across)) return false;
    if (facing.is_corner) {
      // A pair of corners is found from either: it counts once.
      return facing.side > corner.side && is_reentrant(facing.side) && leaves_free(facing.side, -across);
    }
    // The end of a side is looked at as the beginning of the next one.
    if (facing.is_end) return false;
    const Side& side = sides_[facing.side];
    return cross(side.to - side.from, corner.at - side.from) > 0;
  }

  /// Whether both sides at the corner make at least a right angle with a direction into the solid.
  bool leaves_free(std::size_t corner, const Eigen::Vector2d& into_solid) const {
    return direction(corner).dot(into_solid) <= right_angle &&
           direction(sides_[corner].previous).dot(into_solid) >= -right_angle;
  }

  bool holds_disk(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const std::vector<std::size_t>& around) const {
    const Eigen::Vector2d centre = (a + b) / 2;
    const double radius = (1 - right_angle) * (b - a).norm() / 2;
    return std::all_of(around.begin(), around.end(), [&](std::size_t side) {
      return distance_to_segment(centre, sides_[side].from, sides_[side].to) >= radius;
    });
  }

  bool widens_both_ways(const OutlinePoint& corner, const OutlinePoint& facing) const {
    return widens(corner, facing, true) && widens(corner, facing, false);
  }

  /// Whether the solid becomes wider to the left or to the right of the line from the corner to the facing point. Where
  /// the walls are parallel they are followed until they are not: at a dead end they close.
  bool widens(const OutlinePoint& corner, const OutlinePoint& facing, bool to_left) const {
    const Eigen::Vector2d across = (facing.at - corner.at).normalized();
    const double gap = (facing.at - corner.at).norm();
    const Eigen::Vector2d along = to_left ? Eigen::Vector2d(-across.y(), across.x())  // a quarter turn
                                          : Eigen::Vector2d(across.y(), -across.x());
    // The solid lies to the left of its sides, so that its outline leads to the right here and to the left there.
    std::size_t here = to_left ? sides_[corner.side].previous : corner.side;
    std::size_t there = to_left || !facing.is_corner ? facing.side : sides_[facing.side].previous;
    const auto end_here = [&] { return to_left ? sides_[here].from : sides_[here].to; };
    const auto end_there = [&] { return to_left ? sides_[there].to : sides_[there].from; };
    for (int k = 0; k < max_straight_corners; ++k) {
      const Eigen::Vector2d way_here = to_left ? Eigen::Vector2d(-direction(here)) : direction(here);
      const Eigen::Vector2d way_there = to_left ? direction(there) : Eigen::Vector2d(-direction(there));
      const double slope_here = slope(-way_here.dot(across), way_here.dot(along));
      const double slope_there = slope(way_there.dot(across), way_there.dot(along));
      if (slope_here == INFINITY || slope_there == INFINITY) return true;
      const double widening = slope_here + slope_there;
      // A wall that turns keeps its width, and is wider in the bend.
      if (std::abs(widening) > parallel_slope) return widening > 0;
      if (std::abs(slope_here) > parallel_slope) return true;
      const double left_here = (end_here() - corner.at).dot(along), left_there = (end_there() - corner.at).dot(along);
      const bool next_here = left_here <= left_there + opposite * gap;
      const bool next_there = left_there <= left_here + opposite * gap;
      if (next_here) here = to_left ? sides_[here].previous : sides_[here].next;
      if (next_there) there = to_left ? sides_[there].next : sides_[there].previous;
    }
    return true;
  }

  /// How fast a wall leaves the other one; infinite where it turns away or back.
  static double slope(double away, double ahead) {
    if (ahead > right_angle) return away / ahead;
    return away > 0 ? INFINITY : -INFINITY;
  }

  std::vector<Side> sides_;
  Bounds bounds_;
};

}  // namespace

NarrowPlaces narrow_places(const SolidFace& face, double limit, double usual_width) {
  Search search(face);
  double reach = std::max(limit, first_search * usual_width);
  for (;; reach *= wider_search) {
    NarrowPlaces found = search.within(limit, reach);
    if (found.least_of_rest || reach > search.diameter()) return found;
  }
}

}  // namespace supple::tiling
