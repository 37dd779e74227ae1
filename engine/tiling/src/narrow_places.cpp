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

struct OutlineSide {
  Eigen::Vector2d from, to;
  Eigen::Vector2d direction;
  std::size_t previous = 0, next = 0;  ///< the neighbours in its polygon
};

/// Sides by the squares of a grid that they run through. There are about as many squares as sides.
class SideGrid {
 public:
  SideGrid(const std::vector<OutlineSide>& sides, const Bounds& bounds, double least_square) : lower_(bounds.lower) {
    const Eigen::Vector2d size = bounds.upper - bounds.lower;
    square_ = std::max(least_square, size.maxCoeff() / std::sqrt(static_cast<double>(sides.size())));
    columns_ = static_cast<int>(size.x() / square_) + 1;
    rows_ = static_cast<int>(size.y() / square_) + 1;
    std::vector<std::pair<std::size_t, std::uint32_t>> entries;
    entries.reserve(2 * sides.size());
    first_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
    for (std::size_t i = 0; i < sides.size(); ++i) {
      const Eigen::Vector2d way = sides[i].to - sides[i].from;
      const auto pieces = static_cast<int>(way.norm() / square_) + 1;
      for (int k = 0; k < pieces; ++k) {
        const Eigen::Vector2d p = sides[i].from + way * k / pieces, q = sides[i].from + way * (k + 1) / pieces;
        for_each_square(p.cwiseMin(q), p.cwiseMax(q), [&](std::size_t square) {
          entries.emplace_back(square, static_cast<std::uint32_t>(i));
          ++first_[square + 1];
        });
      }
    }
    for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
    sides_.resize(entries.size());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (const auto& [square, side] : entries) sides_[next[square]++] = side;
  }

  /// Calls visit(side) for sides that may come within `radius` of the point, for some of them several times.
  template <class Visit>
  void for_each_near(const Eigen::Vector2d& point, double radius, const Visit& visit) const {
    const Eigen::Vector2d reach = Eigen::Vector2d::Constant(radius);
    for_each_square(point - reach, point + reach, [&](std::size_t square) {
      for (std::size_t k = first_[square]; k < first_[square + 1]; ++k) visit(std::size_t{sides_[k]});
    });
  }

 private:
  template <class Visit>
  void for_each_square(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Visit& visit) const {
    const auto number = [&](double distance, int count) {
      return std::clamp(static_cast<int>(distance / square_), 0, count - 1);
    };
    const int first_column = number(from.x() - lower_.x(), columns_),
              last_column = number(to.x() - lower_.x(), columns_);
    const int last_row = number(to.y() - lower_.y(), rows_);
    for (int row = number(from.y() - lower_.y(), rows_); row <= last_row; ++row) {
      for (int column = first_column; column <= last_column; ++column)
        visit(static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column));
    }
  }

  Eigen::Vector2d lower_;
  double square_ = 1;
  int columns_ = 1, rows_ = 1;
  std::vector<std::size_t> first_;  ///< for each square the place of its first side in sides_
  std::vector<std::uint32_t> sides_;
};

/// A point of a side.
struct OutlinePoint {
  Eigen::Vector2d at;
  std::size_t side = 0;
  bool is_corner = false;  ///< the corner where the side begins
  bool is_end = false;     ///< the corner where it ends and the next one begins
};

class NarrowPlaceSearch {
 public:
  explicit NarrowPlaceSearch(const SolidFace& face) {
    for (const Polygon& polygon : face) {
      const std::size_t first = sides_.size(), n = polygon.size();
      bounds_.include(polygon);
      for (std::size_t k = 0; k < n; ++k) {
        const Eigen::Vector2d &from = polygon[k], &to = polygon[(k + 1) % n];
        sides_.push_back({from, to, (to - from).normalized(), first + (k + n - 1) % n, first + (k + 1) % n});
      }
    }
  }

  double diameter() const { return (bounds_.upper - bounds_.lower).norm(); }

  /// All places narrower than `limit`, and the narrowest of the others up to the width `reach`.
  NarrowPlaces within(double limit, double reach) const {
    const SideGrid grid(sides_, bounds_, reach);
    NarrowPlaces found;
    double widest = reach;  // nothing wider is of interest
    for (std::size_t v = 0; v < sides_.size(); ++v) {
      if (!is_reentrant(v)) continue;
      const OutlinePoint corner{sides_[v].from, v, true, false};
      std::size_t last = v;
      grid.for_each_near(corner.at, std::max(limit, widest), [&](std::size_t side) {
        if (side == v || side == sides_[v].previous || side == last) return;
        last = side;
        const OutlinePoint facing = nearest_point(side, corner.at);
        const double width = (facing.at - corner.at).norm();
        if (!(width > 0) || (width >= limit && width >= widest) || !face_each_other(corner, facing)) return;
        if (!holds_disk(grid, corner.at, facing.at) || !widens_both_ways(corner, facing)) return;
        if (width >= limit)
          found.least_of_rest = widest = width;
        else if (!is_known(found.below, {corner.at, facing.at}))
          found.below.push_back({corner.at, facing.at});
      });
    }
    return found;
  }

 private:
  const Eigen::Vector2d& direction(std::size_t side) const { return sides_[side].direction; }

  /// Whether the solid fills more than half of the surroundings of the corner where the side begins.
  bool is_reentrant(std::size_t side) const {
    const OutlineSide& before = sides_[sides_[side].previous];
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
    const OutlineSide& side = sides_[facing.side];
    return cross(side.to - side.from, corner.at - side.from) > 0;
  }

  /// Whether both sides at the corner make at least a right angle with a direction into the solid.
  bool leaves_free(std::size_t corner, const Eigen::Vector2d& into_solid) const {
    return direction(corner).dot(into_solid) <= right_angle &&
           direction(sides_[corner].previous).dot(into_solid) >= -right_angle;
  }

  bool holds_disk(const SideGrid& grid, const Eigen::Vector2d& a, const Eigen::Vector2d& b) const {
    const Eigen::Vector2d centre = (a + b) / 2;
    const double radius = (1 - right_angle) * (b - a).norm() / 2;
    bool is_free = true;
    grid.for_each_near(centre, radius, [&](std::size_t side) {
      is_free = is_free && distance_to_segment(centre, sides_[side].from, sides_[side].to) >= radius;
    });
    return is_free;
  }

  /// A side that runs through several squares is met several times.
  static bool is_known(const std::vector<NarrowPlace>& places, const NarrowPlace& place) {
    return !places.empty() && places.back().a == place.a && places.back().b == place.b;
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

  std::vector<OutlineSide> sides_;
  Bounds bounds_;
};

}  // namespace

NarrowPlaces narrow_places(const SolidFace& face, double limit, double usual_width) {
  const NarrowPlaceSearch search(face);
  double reach = std::max(limit, first_search * usual_width);
  for (;; reach *= wider_search) {
    NarrowPlaces found = search.within(limit, reach);
    if (found.least_of_rest || reach > search.diameter()) return found;
  }
}

}  // namespace supple::tiling
