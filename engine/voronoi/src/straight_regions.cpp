#include "straight_regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "equal_length_roots.h"
#include "planar_cross.h"
#include "quadrature.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;
using surface::FaceArrival;

/// Relative to the face: lengths and places that differ by less are equal.
constexpr double region_tolerance = 1e-12;
/// Maximum number of successive halvings, and of all halvings of a polygon, where many arrivals from different images
/// compete. What remains then goes to the arrival that is the shortest at its centre.
constexpr int max_halving_depth = 32;
constexpr int max_region_halvings = 4096;
/// Maximum number of divisions of a polygon along lines, halvings included. The lines at which many bundles end divide
/// it into about the square of their number. What remains then goes to the arrival that is the shortest at its centre.
constexpr int max_region_divisions = 1 << 15;
/// Relative to the face: arrivals whose lengths differ by no more at the corners and the centre of a polygon are
/// equally long in it, as behind a vertex at which the paths of all of them turn.
constexpr double tied_length_tolerance = 1e-11;
/// Relative to the chord: maximum height of a border for which slivers are accurate.
constexpr double max_sliver_height = 0.03;
constexpr int max_sliver_steps = 20;
/// Relative to the face: minimum length of a chord that has slivers.
constexpr double min_sliver_chord = 1e-9;

/// The points between `from` and `to` where |x - a| - |x - b| = c, c > 0, as fractions in (0, 1), ascending.
LineRoots roots_between(const Vector2d& a, const Vector2d& b, double c, const Vector2d& from, const Vector2d& to) {
  const Vector2d direction = to - from;
  LineRoots roots;
  const LineRoots candidates = equal_length_roots(a, b, c, from, direction);
  for (std::size_t k = 0; k < candidates.count; ++k) {
    double fraction = candidates.fractions[k];
    if (!(fraction > 0 && fraction < 1)) continue;
    // Newton's method restores the digits that squaring has lost.
    for (int i = 0; i < 2; ++i) {
      const Vector2d from_a = from + fraction * direction - a;
      const Vector2d from_b = from + fraction * direction - b;
      const double slope = from_a.dot(direction) / from_a.norm() - from_b.dot(direction) / from_b.norm();
      const double next = fraction - (from_a.norm() - from_b.norm() - c) / slope;
      if (!(next > 0 && next < 1) || !(std::abs(next - fraction) < 1e-3)) break;
      fraction = next;
    }
    roots.fractions[roots.count++] = fraction;
  }
  if (roots.count == 2 && roots.fractions[1] < roots.fractions[0]) std::swap(roots.fractions[0], roots.fractions[1]);
  return roots;
}

/// The border |x - a| - |x - b| = c, c > 0, of two arrivals with the images a and b. The paths from a, which has the
/// smaller sigma, are longer within the face.
struct Hyperbola {
  Vector2d a, b;
  double c = 0;

  /// Difference of the lengths at x: positive where the arrival from b is shorter.
  double gap(const Vector2d& x) const { return (x - a).norm() - (x - b).norm() - c; }
  /// The largest difference of lengths at a corner, which tells most reliably to which arrival a part belongs.
  double largest_gap(const Polygon& part) const {
    double largest = 0;
    for (const Vector2d& corner : part) {
      const double at = gap(corner);
      if (std::abs(at) > std::abs(largest)) largest = at;
    }
    return largest;
  }
};

/// A polygon's boundary with the points at which a hyperbola cuts it.
struct CutBoundary {
  Polygon corners;                ///< the polygon's corners and the cuts, in order
  std::vector<std::size_t> cuts;  ///< indices of the cuts

  /// The polygon from one corner to another.
  Polygon between(std::size_t begin, std::size_t end) const {
    Polygon part;
    for (std::size_t i = begin;; i = (i + 1) % corners.size()) {
      part.push_back(corners[i]);
      if (i == end) return part;
    }
  }
};

CutBoundary cut_by(const Hyperbola& border, const Polygon& polygon) {
  CutBoundary boundary;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& from = polygon[i];
    const Vector2d& to = polygon[(i + 1) % polygon.size()];
    boundary.corners.push_back(from);
    const LineRoots roots = roots_between(border.a, border.b, border.c, from, to);
    for (std::size_t k = 0; k < roots.count; ++k) {
      boundary.cuts.push_back(boundary.corners.size());
      boundary.corners.push_back(from + roots.fractions[k] * (to - from));
    }
  }
  return boundary;
}

using Slivers = std::array<Sliver, three_nodes.size()>;

/// The slivers between the border and its chord, without their arrivals; none if the border is too strongly curved.
std::optional<Slivers> slivers_between(const Hyperbola& border, const Vector2d& begin, const Vector2d& chord,
                                       double size) {
  const double length = chord.norm();
  const Vector2d normal(-chord.y() / length, chord.x() / length);
  Slivers slivers;
  for (std::size_t k = 0; k < three_nodes.size(); ++k) {
    const Vector2d base = begin + three_nodes[k] * chord;
    double height = 0;
    for (int step = 0; step < max_sliver_steps; ++step) {
      const Vector2d x = base + height * normal;
      const double slope = normal.dot((x - border.a).normalized() - (x - border.b).normalized());
      const double change = -border.gap(x) / slope;
      if (!std::isfinite(change) || std::abs(height + change) > length) return std::nullopt;
      height += change;
      if (std::abs(change) <= region_tolerance * size) break;
    }
    if (std::abs(height) > max_sliver_height * length) return std::nullopt;
    slivers[k] = {-1, -1, base + 0.5 * height * normal, three_weights[k] * height * length};
  }
  return slivers;
}

}  // namespace

void StraightRegions::add(const Polygon& polygon, std::int32_t arrival) const {
  if (polygon.size() >= 3) visit_({arrival, polygon});
}

double StraightRegions::straight_length(std::int32_t arrival, const Vector2d& point) const {
  const FaceArrival& from = distances_.arrivals()[static_cast<std::size_t>(arrival)];
  return from.sigma + (point - from.image).norm();
}

StraightRegions::Outside StraightRegions::outside(std::int32_t arrival, const Vector2d& point) const {
  const FaceArrival& from = distances_.arrivals()[static_cast<std::size_t>(arrival)];
  if (from.everywhere) return {-1, -1};
  const Vector2d to = point - from.image;
  const auto beyond = [&](const Vector2d& end, double side) {
    const Vector2d edge = end - from.image;
    const double length = edge.norm();
    return length > region_tolerance * size_ ? side * cross(edge, to) / length : -1.0;
  };
  return {beyond(from.begin, 1), beyond(from.end, -1)};
}

void StraightRegions::divide(std::span<const Vector2d> polygon, const Active& active) {
  halvings_ = 0;
  divisions_ = 0;
  divide(Polygon(polygon.begin(), polygon.end()), active, 0);
}

void StraightRegions::divide(const Polygon& polygon, const Active& active, int depth) {
  if (polygon.size() < 3 || active.empty()) return;
  Vector2d centre = Vector2d::Zero();
  for (const Vector2d& corner : polygon) centre += corner / static_cast<double>(polygon.size());
  double radius = 0;
  for (const Vector2d& corner : polygon) radius = std::max(radius, (corner - centre).norm());
  if (radius <= region_tolerance * size_) return;
  Active remaining;
  distances_.prune(active, centre, radius, remaining);
  drop_longer(polygon, remaining);
  if (divisions_ >= max_region_divisions) {
    const auto& arrivals = distances_.arrivals();
    return add(polygon, *std::ranges::min_element(remaining, {}, [&](std::int32_t i) {
                 return arrivals[static_cast<std::size_t>(i)].length_to(centre);
               }));
  }
  if (divide_by_bundles(polygon, remaining, depth)) return;
  // Now an arrival reaches either all of the polygon straight or none of it.
  Active straight;
  for (const std::int32_t i : remaining) {
    const Outside at = outside(i, centre);
    if (at.begin <= 0 && at.end <= 0) straight.push_back(i);
  }
  if (straight.empty())
    return add(polygon,
               remaining.front());  // the polygon lies in a gap between bundles that is only as wide as rounding
  drop_longer(polygon, straight);
  if (straight.size() == 1) return add(polygon, straight.front());
  double least = std::numeric_limits<double>::infinity();
  double greatest = 0;
  for (const std::int32_t i : straight) {
    const double sigma = distances_.arrivals()[static_cast<std::size_t>(i)].sigma;
    least = std::min(least, sigma);
    greatest = std::max(greatest, sigma);
  }
  if (greatest - least <= region_tolerance * size_) return divide_by_bisectors(polygon, straight);
  if (straight.size() == 2 && divide_by_hyperbola(polygon, straight[0], straight[1])) return;
  if (depth < max_halving_depth && halvings_ < max_region_halvings && !are_tied(polygon, centre, straight))
    return halve(polygon, straight, depth);
  add(polygon, *std::min_element(straight.begin(), straight.end(), [&](std::int32_t i, std::int32_t j) {
        return straight_length(i, centre) < straight_length(j, centre);
      }));
}

bool StraightRegions::are_tied(const Polygon& polygon, const Vector2d& centre, const Active& active) const {
  const auto tied_at = [&](const Vector2d& place) {
    const double first = straight_length(active.front(), place);
    return std::all_of(active.begin(), active.end(), [&](std::int32_t i) {
      return std::abs(straight_length(i, place) - first) <= tied_length_tolerance * size_;
    });
  };
  return tied_at(centre) && std::all_of(polygon.begin(), polygon.end(), tied_at);
}

void StraightRegions::drop_longer(const Polygon& polygon, Active& active) const {
  distances_.charge(active.size() * active.size());
  const auto& arrivals = distances_.arrivals();
  const auto reaches_all_straight = [&](std::int32_t i) {
    return std::all_of(polygon.begin(), polygon.end(), [&](const Vector2d& corner) {
      const Outside at = outside(i, corner);
      return at.begin <= region_tolerance * size_ && at.end <= region_tolerance * size_;
    });
  };
  // Whether no path from the image of `i` is shorter than the straight path of `j`.
  const auto is_nowhere_shorter = [&](std::int32_t i, std::int32_t j) {
    const FaceArrival& own = arrivals[static_cast<std::size_t>(i)];
    const FaceArrival& other = arrivals[static_cast<std::size_t>(j)];
    const double between = (own.image - other.image).norm();
    if (other.sigma + between <= own.sigma + region_tolerance * size_) return true;
    // The region in which j is shorter is then convex. It contains the polygon if it contains the corners.
    return own.sigma >= other.sigma - region_tolerance * size_ && own.sigma <= other.sigma + region_tolerance * size_ &&
           std::all_of(polygon.begin(), polygon.end(), [&](const Vector2d& corner) {
             return straight_length(j, corner) <= straight_length(i, corner);
           });
  };
  for (std::size_t j = 0; j < active.size(); ++j) {
    if (active.size() == 1 || !reaches_all_straight(active[j])) continue;
    const std::int32_t shorter = active[j];
    std::size_t before = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < active.size(); ++i) {
      if (active[i] != shorter && is_nowhere_shorter(active[i], shorter)) {
        if (i < j) ++before;
        continue;
      }
      active[count++] = active[i];
    }
    active.resize(count);
    j -= before;
  }
}

bool StraightRegions::divide_by_bundles(const Polygon& polygon, const Active& active, int depth) {
  distances_.charge(active.size() * polygon.size());
  for (const std::int32_t i : active) {
    const FaceArrival& from = distances_.arrivals()[static_cast<std::size_t>(i)];
    if (from.everywhere) continue;
    for (const double side : {1.0, -1.0}) {
      double least = 0;
      double greatest = 0;
      for (const Vector2d& corner : polygon) {
        const Outside at = outside(i, corner);
        const double beyond = side > 0 ? at.begin : at.end;
        least = std::min(least, beyond);
        greatest = std::max(greatest, beyond);
      }
      // A polygon that lies outside on the other side does not belong to this arrival.
      if (!(least < -region_tolerance * size_ && greatest > region_tolerance * size_)) continue;
      const Vector2d edge = (side > 0 ? from.begin : from.end) - from.image;
      const Vector2d normal = side * Vector2d(-edge.y(), edge.x()).normalized();
      divide_by_line(polygon, normal, normal.dot(from.image), active, depth);
      return true;
    }
  }
  return false;
}

void StraightRegions::divide_by_line(const Polygon& polygon, const Vector2d& normal, double offset,
                                     const Active& active, int depth) {
  ++divisions_;
  Polygon part;
  clip(polygon, normal, offset, part);
  divide(part, active, depth);
  clip(polygon, -normal, -offset, part);
  divide(part, active, depth);
}

void StraightRegions::halve(const Polygon& polygon, const Active& active, int depth) {
  ++halvings_;
  std::size_t first = 0;
  std::size_t second = 1;
  double longest = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double length = (polygon[i] - polygon[j]).squaredNorm();
      if (!(length > longest)) continue;
      longest = length;
      first = i;
      second = j;
    }
  }
  const Vector2d normal = (polygon[second] - polygon[first]).normalized();
  divide_by_line(polygon, normal, 0.5 * normal.dot(polygon[first] + polygon[second]), active, depth + 1);
}

void StraightRegions::divide_by_bisectors(const Polygon& polygon, const Active& active) {
  const auto& arrivals = distances_.arrivals();
  Polygon part;
  Polygon next;
  for (const std::int32_t i : active) {
    distances_.charge(active.size() * polygon.size());
    const Vector2d& own = arrivals[static_cast<std::size_t>(i)].image;
    part = polygon;
    for (const std::int32_t j : active) {
      if (j == i) continue;
      const Vector2d& other = arrivals[static_cast<std::size_t>(j)].image;
      const Vector2d normal = (other - own).normalized();
      clip(part, normal, 0.5 * normal.dot(own + other), next);
      part.swap(next);
    }
    add(part, i);
  }
}

bool StraightRegions::divide_by_hyperbola(const Polygon& polygon, std::int32_t one, std::int32_t other) {
  const auto& arrivals = distances_.arrivals();
  if (arrivals[static_cast<std::size_t>(one)].sigma > arrivals[static_cast<std::size_t>(other)].sigma)
    std::swap(one, other);
  const FaceArrival& longer = arrivals[static_cast<std::size_t>(one)];
  const FaceArrival& shorter = arrivals[static_cast<std::size_t>(other)];
  const Hyperbola border{longer.image, shorter.image, shorter.sigma - longer.sigma};
  const CutBoundary boundary = cut_by(border, polygon);
  const std::vector<std::size_t>& cuts = boundary.cuts;
  const auto nearer = [&](double gap) { return gap > 0 ? other : one; };
  if (cuts.size() < 2) {
    // If the border passes through a corner, its crossing with a side may be missing there.
    double least = 0;
    double greatest = 0;
    for (const Vector2d& corner : polygon) {
      least = std::min(least, border.gap(corner));
      greatest = std::max(greatest, border.gap(corner));
    }
    if (cuts.size() == 1 && least < -region_tolerance * size_ && greatest > region_tolerance * size_) return false;
    add(polygon, nearer(border.largest_gap(polygon)));
    return true;
  }
  if (cuts.size() > 2) return false;
  const Polygon first = boundary.between(cuts[0], cuts[1]);
  const Polygon second = boundary.between(cuts[1], cuts[0]);
  // A part at a corner through which the border passes is too small to decide by its own gap.
  const double at_first = border.largest_gap(first);
  const double at_second = border.largest_gap(second);
  const std::int32_t left = std::abs(at_first) > std::abs(at_second) ? nearer(at_first) : nearer(-at_second);
  const std::int32_t right = left == one ? other : one;
  // The chord goes from the second cut to the first, with `first` on its left.
  const Vector2d& begin = boundary.corners[cuts[1]];
  const Vector2d chord = boundary.corners[cuts[0]] - begin;
  if (chord.norm() > min_sliver_chord * size_) {
    auto slivers = slivers_between(border, begin, chord, size_);
    if (!slivers) return false;
    for (Sliver& sliver : *slivers) {
      sliver.loses = left;
      sliver.gains = right;
      slivers_.push_back(sliver);
    }
  }
  add(first, left);
  add(second, right);
  return true;
}

}  // namespace supple::voronoi
