#include "bisector_borders.h"

#include <algorithm>
#include <cmath>

#include "planar_cross.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;

/// Relative to the face: where two ways of finding a place of a border must agree.
constexpr double same_crossing = 1e-9;
/// Relative to the distance: as far do distances to the images of a point differ at most.
constexpr double equal_lengths = 2e-13;
/// Parts of sides, of all cells of a polygon.
constexpr std::size_t most_arcs = 96;

}  // namespace

BisectorBorders::Meeting BisectorBorders::meeting(std::size_t image, std::int32_t before, std::int32_t after) {
  Meeting result{static_cast<std::int32_t>(image), before, after};
  std::sort(result.begin(), result.end());
  return result;
}

bool BisectorBorders::find_crossings(std::span<const Vector2d> polygon, std::span<const BoundaryVertex> boundary,
                                     std::span<const std::size_t> cuts, double size) {
  const auto images = cells_.images();
  const auto cells = cells_.cells();
  const auto site_of = [&](std::int32_t image) { return images[static_cast<std::size_t>(image)].site; };
  struct Arc {
    std::int32_t side;
    double along;  ///< squared, from the beginning of the side to the middle of the arc
    std::int32_t image;
    Vector2d begin;
  };
  std::array<Arc, most_arcs> arcs;
  std::size_t count = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for (std::size_t k = 0; k < cells[i].count; ++k) {
      const BisectorCells::Corner& corner = cells[i].corner(k);
      if (corner.beyond >= 0) continue;
      if (count == arcs.size()) return false;
      const std::int32_t side = -1 - corner.beyond;
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
    // The first arc follows the last one at the first corner.
    const Arc& before = arcs[k > 0 ? k - 1 : count - 1];
    const Arc& after = arcs[k];
    if (site_of(before.image) == site_of(after.image)) continue;
    if (before.side != after.side || next == cuts.size()) return false;
    const BoundaryVertex& cut = boundary[cuts[next]];
    const BoundaryVertex& ahead = boundary[cuts[next] - 1];
    if (cut.site != site_of(after.image) || ahead.site != site_of(before.image) ||
        !((cut.place - after.begin).norm() <= same_crossing * size))
      return false;
    crossings_.push_back({after.side, before.image, after.image, cut.cut});
    ++next;
  }
  return next == cuts.size();
}

bool BisectorBorders::add_end(const Meeting& meeting, const Vector2d& about, double size) {
  if (known_end(meeting) != no_end) return true;
  const auto& [first, second, third] = meeting;
  if (second < 0) return false;
  if (first < 0) {
    for (const Crossing& crossing : crossings_) {
      if (crossing.side != -1 - first || std::min(crossing.one, crossing.other) != second ||
          std::max(crossing.one, crossing.other) != third)
        continue;
      ends_.emplace_back(meeting, crossing.cut);
      return true;
    }
    return false;
  }
  const BisectorCells::Image& a = cells_.images()[static_cast<std::size_t>(first)];
  const BisectorCells::Image& b = cells_.images()[static_cast<std::size_t>(second)];
  const BisectorCells::Image& c = cells_.images()[static_cast<std::size_t>(third)];
  // As far from all three: two linear equations of the way from a place nearby.
  const Vector2d to_b = b.place - a.place;
  const Vector2d to_c = c.place - a.place;
  const double by_b = 0.5 * to_b.dot(a.place + b.place - 2 * about);
  const double by_c = 0.5 * to_c.dot(a.place + c.place - 2 * about);
  const Vector2d place =
      about + Vector2d(by_b * to_c.y() - by_c * to_b.y(), by_c * to_b.x() - by_b * to_c.x()) / cross(to_b, to_c);
  const std::array<double, 3> lengths{(place - a.place).norm(), (place - b.place).norm(), (place - c.place).norm()};
  const auto [least, greatest] = std::minmax_element(lengths.begin(), lengths.end());
  if (!(*greatest - *least <= equal_lengths * *greatest) || !((place - about).norm() <= same_crossing * size))
    return false;
  ends_.emplace_back(meeting, first_point_ + static_cast<std::int32_t>(points_.size()));
  points_.push_back({place, cells_.sigma() + lengths[0], a.site != b.site && a.site != c.site && b.site != c.site});
  return true;
}

std::int32_t BisectorBorders::known_end(const Meeting& meeting) const {
  for (const auto& [known, end] : ends_)
    if (known == meeting) return end;
  return no_end;
}

bool BisectorBorders::find(const FaceDistances& distances, const Active& kept, std::span<const Vector2d> polygon,
                           std::span<const BoundaryVertex> boundary, std::span<const std::size_t> cuts,
                           std::int32_t first_point, double size) {
  first_point_ = first_point;
  half_borders_.clear();
  ends_.clear();
  points_.clear();
  borders_.clear();
  if (!cells_.find(distances, kept, polygon, size) || !find_crossings(polygon, boundary, cuts, size)) return false;
  const auto images = cells_.images();
  const auto cells = cells_.cells();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto image = static_cast<std::int32_t>(i);
    for (std::size_t k = 0; k < cells[i].count; ++k) {
      const std::int32_t other = cells[i].corner(k).beyond;
      if (other < 0 || images[static_cast<std::size_t>(other)].site == images[i].site) continue;
      const Meeting from = meeting(i, cells[i].before(k).beyond, other);
      const Meeting to = meeting(i, other, cells[i].after(k).beyond);
      if (image < other) {
        half_borders_.push_back({image, other, from, to, cells[i].corner(k).place, cells[i].after(k).place, false});
        continue;
      }
      const auto same = std::find_if(half_borders_.begin(), half_borders_.end(), [&](const HalfBorder& border) {
        return border.left == other && border.right == image;
      });
      if (same == half_borders_.end() || same->from != to || same->to != from) return false;
      same->twice = true;
    }
  }
  // In the order of images, which does not depend on where cells begin.
  std::sort(half_borders_.begin(), half_borders_.end(), [](const HalfBorder& a, const HalfBorder& b) {
    return a.left != b.left ? a.left < b.left : a.right < b.right;
  });
  for (const HalfBorder& border : half_borders_) {
    if (!border.twice || !add_end(border.from, border.begin, size) || !add_end(border.to, border.end, size))
      return false;
    borders_.push_back({known_end(border.from), known_end(border.to),
                        images[static_cast<std::size_t>(border.left)].site,
                        images[static_cast<std::size_t>(border.right)].site, 0});
  }
  return true;
}

}  // namespace supple::voronoi
