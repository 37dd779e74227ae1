#include "bisector_borders.h"

#include <algorithm>
#include <cmath>

#include "planar_cross.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;

/// Relative to the face: maximum deviation of the clipped cells from the cuts of the sides, and from the computed ends
/// of borders.
constexpr double crossing_tolerance = 1e-9;
/// Relative to the distance: maximum difference of a point's distances from its three images.
constexpr double distance_tolerance = 2e-13;
/// Maximum number of arcs of all cells on the sides of a polygon.
constexpr std::size_t max_arcs = 96;

}  // namespace

BisectorBorders::EndKey BisectorBorders::end_key(std::size_t image, std::int32_t before, std::int32_t after) {
  EndKey result{static_cast<std::int32_t>(image), before, after};
  std::sort(result.begin(), result.end());
  return result;
}

bool BisectorBorders::find_crossings(std::span<const Vector2d> polygon, std::span<const BoundaryVertex> boundary,
                                     std::span<const std::size_t> cuts, double size) {
  const auto images = cells_.images();
  const auto cells = cells_.cells();
  const auto site_of = [&](std::int32_t image) { return images[static_cast<std::size_t>(image)].site; };
  /// A part of a side that belongs to one image.
  struct Arc {
    std::int32_t side;
    double along;  ///< squared distance from the beginning of the side to the middle of the arc
    std::int32_t image;
    Vector2d begin;
  };
  std::array<Arc, max_arcs> arcs;
  std::size_t count = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for (std::size_t k = 0; k < cells[i].count; ++k) {
      const BisectorCells::Corner& corner = cells[i].corner(k);
      if (corner.neighbour >= 0) continue;
      if (count == arcs.size()) return false;
      const std::int32_t side = -1 - corner.neighbour;
      const Vector2d middle = 0.5 * (corner.place + cells[i].after(k).place);
      arcs[count++] = {side, (middle - polygon[static_cast<std::size_t>(side)]).squaredNorm(),
                       static_cast<std::int32_t>(i), corner.place};
    }
  }
  std::sort(arcs.begin(), arcs.begin() + static_cast<std::ptrdiff_t>(count),
            [](const Arc& a, const Arc& b) { return a.side != b.side ? a.side < b.side : a.along < b.along; });
  crossings_.clear();
  std::size_t next = 0;
  for (std::size_t k = 0; k < count; ++k) {
    // Arcs are cyclic: the last one precedes the first.
    const Arc& before = arcs[k > 0 ? k - 1 : count - 1];
    const Arc& after = arcs[k];
    if (site_of(before.image) == site_of(after.image)) continue;
    if (before.side != after.side || next == cuts.size()) return false;
    const BoundaryVertex& cut = boundary[cuts[next]];
    const BoundaryVertex& ahead = boundary[cuts[next] - 1];
    if (cut.site != site_of(after.image) || ahead.site != site_of(before.image) ||
        !((cut.place - after.begin).norm() <= crossing_tolerance * size))
      return false;
    crossings_.push_back({after.side, before.image, after.image, cut.cut});
    ++next;
  }
  return next == cuts.size();
}

bool BisectorBorders::add_end(const EndKey& key, const Vector2d& guess, double size) {
  if (find_end(key) != no_end) return true;
  const auto& [first, second, third] = key;
  if (second < 0) return false;
  if (first < 0) {
    for (const Crossing& crossing : crossings_) {
      if (crossing.side != -1 - first || std::min(crossing.one, crossing.other) != second ||
          std::max(crossing.one, crossing.other) != third)
        continue;
      ends_.emplace_back(key, crossing.cut);
      return true;
    }
    return false;
  }
  const BisectorCells::Image& a = cells_.images()[static_cast<std::size_t>(first)];
  const BisectorCells::Image& b = cells_.images()[static_cast<std::size_t>(second)];
  const BisectorCells::Image& c = cells_.images()[static_cast<std::size_t>(third)];
  // Equal distance from all three images: two linear equations for the displacement from the guess.
  const Vector2d to_b = b.place - a.place;
  const Vector2d to_c = c.place - a.place;
  const double rhs_b = 0.5 * to_b.dot(a.place + b.place - 2 * guess);
  const double rhs_c = 0.5 * to_c.dot(a.place + c.place - 2 * guess);
  const Vector2d place =
      guess + Vector2d(rhs_b * to_c.y() - rhs_c * to_b.y(), rhs_c * to_b.x() - rhs_b * to_c.x()) / cross(to_b, to_c);
  const std::array<double, 3> lengths{(place - a.place).norm(), (place - b.place).norm(), (place - c.place).norm()};
  const auto [least, greatest] = std::minmax_element(lengths.begin(), lengths.end());
  if (!(*greatest - *least <= distance_tolerance * *greatest) || !((place - guess).norm() <= crossing_tolerance * size))
    return false;
  ends_.emplace_back(key, first_point_ + static_cast<std::int32_t>(points_.size()));
  points_.push_back({place, cells_.sigma() + lengths[0], a.site != b.site && a.site != c.site && b.site != c.site});
  return true;
}

std::int32_t BisectorBorders::find_end(const EndKey& key) const {
  for (const auto& [stored, end] : ends_)
    if (stored == key) return end;
  return no_end;
}

bool BisectorBorders::find(const FaceDistances& distances, const Active& active, std::span<const Vector2d> polygon,
                           std::span<const BoundaryVertex> boundary, std::span<const std::size_t> cuts,
                           std::int32_t first_point, double size) {
  first_point_ = first_point;
  half_borders_.clear();
  ends_.clear();
  points_.clear();
  borders_.clear();
  if (!cells_.find(distances, active, polygon, size) || !find_crossings(polygon, boundary, cuts, size)) return false;
  const auto images = cells_.images();
  const auto cells = cells_.cells();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto image = static_cast<std::int32_t>(i);
    for (std::size_t k = 0; k < cells[i].count; ++k) {
      const std::int32_t other = cells[i].corner(k).neighbour;
      if (other < 0 || images[static_cast<std::size_t>(other)].site == images[i].site) continue;
      const EndKey from = end_key(i, cells[i].before(k).neighbour, other);
      const EndKey to = end_key(i, other, cells[i].after(k).neighbour);
      if (image < other) {
        half_borders_.push_back({image, other, from, to, cells[i].corner(k).place, cells[i].after(k).place, false});
        continue;
      }
      const auto match = std::find_if(half_borders_.begin(), half_borders_.end(), [&](const HalfBorder& border) {
        return border.left == other && border.right == image;
      });
      if (match == half_borders_.end() || match->from != to || match->to != from) return false;
      match->matched = true;
    }
  }
  // The order of images does not depend on the corner at which a cell begins.
  std::sort(half_borders_.begin(), half_borders_.end(), [](const HalfBorder& a, const HalfBorder& b) {
    return a.left != b.left ? a.left < b.left : a.right < b.right;
  });
  for (const HalfBorder& border : half_borders_) {
    if (!border.matched || !add_end(border.from, border.begin, size) || !add_end(border.to, border.end, size))
      return false;
    borders_.push_back({find_end(border.from), find_end(border.to), images[static_cast<std::size_t>(border.left)].site,
                        images[static_cast<std::size_t>(border.right)].site, 0});
  }
  return true;
}

}  // namespace supple::voronoi
