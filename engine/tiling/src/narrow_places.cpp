#include "narrow_places.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "polygon.h"

namespace supple::tiling {
namespace {

/// Tolerance for rounding, of the cosine of a right angle, and of the radius of the disk between two points.
constexpr double rounding_tolerance = 1e-6;
/// Walls that approach or leave each other by less than this slope are parallel.
constexpr double parallel_slope = 1e-4;
/// Corners of two parallel walls are opposite each other if their offset along the walls is below this ratio to the
/// walls' distance.
constexpr double opposite_tolerance = 1e-6;
/// Limit of the corners over which parallel walls are followed. These corners are almost straight.
constexpr int max_straight_corners = 100;
/// The first search finds places up to this factor times the usual width; each further search extends this width by the
/// other factor.
constexpr double first_width_factor = 2;
constexpr double width_factor = 8;

struct OutlineSide {
  Eigen::Vector2d from, to;
  Eigen::Vector2d direction;
  std::size_t previous = 0, next = 0;  ///< the neighbours in its polygon
};

/// A grid whose squares list the sides that run through them. There are about as many squares as sides.
class SideGrid {
 public:
  SideGrid(const std::vector<OutlineSide>& sides, const Bounds& bounds, double min_square_side) : lower_(bounds.lower) {
    const Eigen::Vector2d size = bounds.upper - bounds.lower;
    square_side_ = std::max(min_square_side, size.maxCoeff() / std::sqrt(static_cast<double>(sides.size())));
    columns_ = static_cast<int>(size.x() / square_side_) + 1;
    rows_ = static_cast<int>(size.y() / square_side_) + 1;
    std::vector<std::pair<std::size_t, std::uint32_t>> entries;
    entries.reserve(2 * sides.size());
    first_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
    for (std::size_t i = 0; i < sides.size(); ++i) {
      const Eigen::Vector2d displacement = sides[i].to - sides[i].from;
      const auto pieces = static_cast<int>(displacement.norm() / square_side_) + 1;
      for (int k = 0; k < pieces; ++k) {
        const Eigen::Vector2d p = sides[i].from + displacement * k / pieces,
                              q = sides[i].from + displacement * (k + 1) / pieces;
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
      return std::clamp(static_cast<int>(distance / square_side_), 0, count - 1);
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
  double square_side_ = 1;
  int columns_ = 1, rows_ = 1;
  std::vector<std::size_t> first_;  ///< for each square, the index of its first side in sides_
  std::vector<std::uint32_t> sides_;
};

/// A point of a side.
struct OutlinePoint {
  Eigen::Vector2d position;
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

  /// All places narrower than `limit`, and the width of the narrowest other one up to `max_width`.
  NarrowPlaces within(double limit, double max_width) const {
    const SideGrid grid(sides_, bounds_, max_width);
    NarrowPlaces found;
    double max_relevant_width = max_width;  // wider places do not matter
    for (std::size_t v = 0; v < sides_.size(); ++v) {
      if (!is_reentrant(v)) continue;
      const OutlinePoint corner{sides_[v].from, v, true, false};
      std::size_t last = v;
      grid.for_each_near(corner.position, std::max(limit, max_relevant_width), [&](std::size_t side) {
        if (side == v || side == sides_[v].previous || side == last) return;
        last = side;
        const OutlinePoint facing = nearest_point(side, corner.position);
        const double width = (facing.position - corner.position).norm();
        if (!(width > 0) || (width >= limit && width >= max_relevant_width) || !face_each_other(corner, facing)) return;
        if (!holds_disk(grid, corner.position, facing.position) || !widens_both_ways(corner, facing)) return;
        if (width >= limit)
          found.narrowest_other = max_relevant_width = width;
        else if (!is_known(found.below, {corner.position, facing.position}))
          found.below.push_back({corner.position, facing.position});
      });
    }
    return found;
  }

 private:
  const Eigen::Vector2d& direction(std::size_t side) const { return sides_[side].direction; }

  /// Whether the corner where the side begins is re-entrant: the solid's angle there exceeds 180 degrees.
  bool is_reentrant(std::size_t side) const {
    const OutlineSide& before = sides_[sides_[side].previous];
    return cross(before.to - before.from, sides_[side].to - sides_[side].from) < 0;
  }

  OutlinePoint nearest_point(std::size_t side, const Eigen::Vector2d& p) const {
    const Eigen::Vector2d displacement = sides_[side].to - sides_[side].from;
    const double t = std::clamp((p - sides_[side].from).dot(displacement) / displacement.squaredNorm(), 0.0, 1.0);
    return {sides_[side].from + t * displacement, side, t == 0, t == 1};
  }

  /// Whether the solid lies between the points, and the outline near them does not enter the disk between them.
  bool face_each_other(const OutlinePoint& corner, const OutlinePoint& facing) const {
    const Eigen::Vector2d across = (facing.position - corner.position).normalized();
    if (!leaves_free(corner.side, across)) return false;
    if (facing.is_corner) {
      // A pair of corners is found from both of them, and counts once.
      return facing.side > corner.side && is_reentrant(facing.side) && leaves_free(facing.side, -across);
    }
    // The end of a side is examined as the beginning of the next one.
    if (facing.is_end) return false;
    const OutlineSide& side = sides_[facing.side];
    return cross(side.to - side.from, corner.position - side.from) > 0;
  }

  /// Whether both sides at the corner make at least a right angle with a direction into the solid.
  bool leaves_free(std::size_t corner, const Eigen::Vector2d& into_solid) const {
    return direction(corner).dot(into_solid) <= rounding_tolerance &&
           direction(sides_[corner].previous).dot(into_solid) >= -rounding_tolerance;
  }

  /// Whether no side enters the disk whose diameter joins a and b.
  bool holds_disk(const SideGrid& grid, const Eigen::Vector2d& a, const Eigen::Vector2d& b) const {
    const Eigen::Vector2d centre = (a + b) / 2;
    const double radius = (1 - rounding_tolerance) * (b - a).norm() / 2;
    bool is_free = true;
    grid.for_each_near(centre, radius, [&](std::size_t side) {
      is_free = is_free && distance_to_segment(centre, sides_[side].from, sides_[side].to) >= radius;
    });
    return is_free;
  }

  /// Whether the place was found just before: a side that runs through several squares is visited several times.
  static bool is_known(const std::vector<NarrowPlace>& places, const NarrowPlace& place) {
    return !places.empty() && places.back().a == place.a && places.back().b == place.b;
  }

  bool widens_both_ways(const OutlinePoint& corner, const OutlinePoint& facing) const {
    return widens(corner, facing, true) && widens(corner, facing, false);
  }

  /// Whether the solid becomes wider to the left, or to the right, of the line from the corner to the facing point.
  /// Parallel walls are followed until they are no longer parallel. At a dead end they approach each other.
  bool widens(const OutlinePoint& corner, const OutlinePoint& facing, bool to_left) const {
    const Eigen::Vector2d across = (facing.position - corner.position).normalized();
    const double gap = (facing.position - corner.position).norm();
    const Eigen::Vector2d along = to_left ? Eigen::Vector2d(-across.y(), across.x())  // `across`, rotated by 90 degrees
                                          : Eigen::Vector2d(across.y(), -across.x());
    // The solid lies to the left of its sides: they lead to the right at the corner, and to the left at the facing
    // point.
    std::size_t here = to_left ? sides_[corner.side].previous : corner.side;
    std::size_t there = to_left || !facing.is_corner ? facing.side : sides_[facing.side].previous;
    const auto end_here = [&] { return to_left ? sides_[here].from : sides_[here].to; };
    const auto end_there = [&] { return to_left ? sides_[there].to : sides_[there].from; };
    for (int k = 0; k < max_straight_corners; ++k) {
      const Eigen::Vector2d direction_here = to_left ? Eigen::Vector2d(-direction(here)) : direction(here);
      const Eigen::Vector2d direction_there = to_left ? direction(there) : Eigen::Vector2d(-direction(there));
      const double slope_here = slope(-direction_here.dot(across), direction_here.dot(along));
      const double slope_there = slope(direction_there.dot(across), direction_there.dot(along));
      if (slope_here == INFINITY || slope_there == INFINITY) return true;
      const double widening = slope_here + slope_there;
      // A wall that bends keeps its width, and is wider in the bend.
      if (std::abs(widening) > parallel_slope) return widening > 0;
      if (std::abs(slope_here) > parallel_slope) return true;
      const double remaining_here = (end_here() - corner.position).dot(along),
                   remaining_there = (end_there() - corner.position).dot(along);
      const bool next_here = remaining_here <= remaining_there + opposite_tolerance * gap;
      const bool next_there = remaining_there <= remaining_here + opposite_tolerance * gap;
      if (next_here) here = to_left ? sides_[here].previous : sides_[here].next;
      if (next_there) there = to_left ? sides_[there].next : sides_[there].previous;
    }
    return true;
  }

  /// How fast a wall departs from the other one, per length ahead; infinite if it turns at a right angle or back.
  static double slope(double departure, double ahead) {
    if (ahead > rounding_tolerance) return departure / ahead;
    return departure > 0 ? INFINITY : -INFINITY;
  }

  std::vector<OutlineSide> sides_;
  Bounds bounds_;
};

}  // namespace

NarrowPlaces narrow_places(const SolidFace& face, double limit, double usual_width) {
  const NarrowPlaceSearch search(face);
  double max_width = std::max(limit, first_width_factor * usual_width);
  for (;; max_width *= width_factor) {
    NarrowPlaces found = search.within(limit, max_width);
    if (found.narrowest_other || max_width > search.diameter()) return found;
  }
}

}  // namespace supple::tiling
