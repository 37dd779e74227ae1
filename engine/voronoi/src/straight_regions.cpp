#include "straight_regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "equal_length_roots.h"
#include "planar_cross.h"
#include "quadrature.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;
using surface::FaceArrival;

/// Relative to the face: lengths and places that differ by less are the same.
constexpr double same_region = 1e-12;
/// A part of a polygon is halved this often at most, and all of them together, where many arrivals of different images
/// compete: what is left by then goes to the arrival that is shortest in its middle.
constexpr int max_depth = 32;
constexpr int max_halvings = 4096;
/// Relative to the face: arrivals whose lengths differ by no more at the corners and in the middle of a polygon are
/// equally long in it, as behind a vertex at which the paths of all of them turn.
constexpr double tied_region = 1e-11;
/// A border that bulges by a smaller part of its chord is a curve that slivers make up for.
constexpr double flat_bulge = 0.03;
constexpr int max_sliver_steps = 20;

/// Where |x - a| - |x - b| = c, c > 0, on the way from `from` to `to`: fractions in (0, 1), ascending.
LineRoots roots_between(const Vector2d& a, const Vector2d& b, double c, const Vector2d& from, const Vector2d& to) {
  const Vector2d way = to - from;
  LineRoots roots;
  const LineRoots candidates = equal_length_roots(a, b, c, from, way);
  for (std::size_t k = 0; k < candidates.count; ++k) {
    double fraction = candidates.fractions[k];
    if (!(fraction > 0 && fraction < 1)) continue;
    // Newton's method brings back the digits that squaring has lost.
    for (int i = 0; i < 2; ++i) {
      const Vector2d from_a = from + fraction * way - a;
      const Vector2d from_b = from + fraction * way - b;
      const double slope = from_a.dot(way) / from_a.norm() - from_b.dot(way) / from_b.norm();
      const double next = fraction - (from_a.norm() - from_b.norm() - c) / slope;
      if (!(next > 0 && next < 1) || !(std::abs(next - fraction) < 1e-3)) break;
      fraction = next;
    }
    roots.fractions[roots.count++] = fraction;
  }
  if (roots.count == 2 && roots.fractions[1] < roots.fractions[0]) std::swap(roots.fractions[0], roots.fractions[1]);
  return roots;
}

}  // namespace

void StraightRegions::clear() {
  regions_.clear();
  corners_.clear();
  slivers_.clear();
}

StraightRegion StraightRegions::region(std::size_t i) const {
  const Stored& stored = regions_[i];
  return {stored.arrival, {corners_.data() + stored.first_corner, stored.corners}};
}

void StraightRegions::add(const Polygon& polygon, std::int32_t arrival) {
  if (polygon.size() < 3) return;
  regions_.push_back({arrival, corners_.size(), polygon.size()});
  corners_.insert(corners_.end(), polygon.begin(), polygon.end());
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
    return length > same_region * size_ ? side * cross(edge, to) / length : -1.0;
  };
  return {beyond(from.begin, 1), beyond(from.end, -1)};
}

void StraightRegions::divide(std::span<const Vector2d> polygon, const Active& active) {
  halvings_ = 0;
  divide(Polygon(polygon.begin(), polygon.end()), active, 0);
}

void StraightRegions::divide(const Polygon& polygon, const Active& active, int depth) {
  if (polygon.size() < 3 || active.empty()) return;
  Vector2d centre = Vector2d::Zero();
  for (const Vector2d& corner : polygon) centre += corner / static_cast<double>(polygon.size());
  double radius = 0;
  for (const Vector2d& corner : polygon) radius = std::max(radius, (corner - centre).norm());
  if (radius <= same_region * size_) return;
  Active kept;
  distances_.prune(active, centre, radius, kept);
  drop_longer(polygon, kept);
  if (divided_by_bundles(polygon, kept, depth)) return;
  // Here all of the polygon sees an image or none of it does.
  Active seen;
  for (const std::int32_t i : kept) {
    const Outside at = outside(i, centre);
    if (at.begin <= 0 && at.end <= 0) seen.push_back(i);
  }
  if (seen.empty()) return add(polygon, kept.front());  // a gap as wide as rounding
  drop_longer(polygon, seen);
  if (seen.size() == 1) return add(polygon, seen.front());
  double least = std::numeric_limits<double>::infinity();
  double greatest = 0;
  for (const std::int32_t i : seen) {
    const double sigma = distances_.arrivals()[static_cast<std::size_t>(i)].sigma;
    least = std::min(least, sigma);
    greatest = std::max(greatest, sigma);
  }
  if (greatest - least <= same_region * size_) return divide_by_bisectors(polygon, seen);
  if (seen.size() == 2 && divide_by_curve(polygon, seen[0], seen[1])) return;
  if (depth < max_depth && halvings_ < max_halvings && !are_tied(polygon, centre, seen))
    return halve(polygon, seen, depth);
  add(polygon, *std::min_element(seen.begin(), seen.end(), [&](std::int32_t i, std::int32_t j) {
        return straight_length(i, centre) < straight_length(j, centre);
      }));
}

bool StraightRegions::are_tied(const Polygon& polygon, const Vector2d& centre, const Active& active) const {
  const auto tied_at = [&](const Vector2d& place) {
    const double first = straight_length(active.front(), place);
    return std::all_of(active.begin(), active.end(), [&](std::int32_t i) {
      return std::abs(straight_length(i, place) - first) <= tied_region * size_;
    });
  };
  return tied_at(centre) && std::all_of(polygon.begin(), polygon.end(), tied_at);
}

void StraightRegions::drop_longer(const Polygon& polygon, Active& active) const {
  distances_.charge(active.size() * active.size());
  const auto& arrivals = distances_.arrivals();
  const auto seen_by_all = [&](std::int32_t i) {
    return std::all_of(polygon.begin(), polygon.end(), [&](const Vector2d& corner) {
      const Outside at = outside(i, corner);
      return at.begin <= same_region * size_ && at.end <= same_region * size_;
    });
  };
  // Whether no path from the image of `i` is shorter than the straight one of `j`.
  const auto longer = [&](std::int32_t i, std::int32_t j) {
    const FaceArrival& own = arrivals[static_cast<std::size_t>(i)];
    const FaceArrival& other = arrivals[static_cast<std::size_t>(j)];
    const double between = (own.image - other.image).norm();
    if (other.sigma + between <= own.sigma + same_region * size_) return true;
    // Where j is shorter is convex then: it has all of the polygon if it has the corners.
    return own.sigma >= other.sigma - same_region * size_ && own.sigma <= other.sigma + same_region * size_ &&
           std::all_of(polygon.begin(), polygon.end(), [&](const Vector2d& corner) {
             return straight_length(j, corner) <= straight_length(i, corner);
           });
  };
  for (std::size_t j = 0; j < active.size(); ++j) {
    if (active.size() == 1 || !seen_by_all(active[j])) continue;
    const std::int32_t stays = active[j];
    std::size_t before = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < active.size(); ++i) {
      if (active[i] != stays && longer(active[i], stays)) {
        if (i < j) ++before;
        continue;
      }
      active[count++] = active[i];
    }
    active.resize(count);
    j -= before;
  }
}

bool StraightRegions::divided_by_bundles(const Polygon& polygon, const Active& active, int depth) {
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
      // A polygon that lies outside on the other side is none of this arrival's.
      if (!(least < -same_region * size_ && greatest > same_region * size_)) continue;
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

bool StraightRegions::divide_by_curve(const Polygon& polygon, std::int32_t one, std::int32_t other) {
  const auto& arrivals = distances_.arrivals();
  // The nearer (pseudo-)source of the two has more to go in the face: |x - a| - |x - b| = c > 0.
  if (arrivals[static_cast<std::size_t>(one)].sigma > arrivals[static_cast<std::size_t>(other)].sigma)
    std::swap(one, other);
  const Vector2d& a = arrivals[static_cast<std::size_t>(one)].image;
  const Vector2d& b = arrivals[static_cast<std::size_t>(other)].image;
  const double c = arrivals[static_cast<std::size_t>(other)].sigma - arrivals[static_cast<std::size_t>(one)].sigma;
  const auto gap = [&](const Vector2d& x) { return (x - a).norm() - (x - b).norm() - c; };
  Polygon boundary;
  std::vector<std::size_t> cuts;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& from = polygon[i];
    const Vector2d& to = polygon[(i + 1) % polygon.size()];
    boundary.push_back(from);
    const LineRoots roots = roots_between(a, b, c, from, to);
    for (std::size_t k = 0; k < roots.count; ++k) {
      cuts.push_back(boundary.size());
      boundary.push_back(from + roots.fractions[k] * (to - from));
    }
  }
  const auto part_between = [&](std::size_t begin, std::size_t end) {
    Polygon part;
    for (std::size_t i = begin;; i = (i + 1) % boundary.size()) {
      part.push_back(boundary[i]);
      if (i == end) return part;
    }
  };
  // The difference of lengths at the corner that tells most surely whose a part is.
  const auto surest_gap = [&](const Polygon& part) {
    double surest = 0;
    for (const Vector2d& corner : part) {
      const double at = gap(corner);
      if (std::abs(at) > std::abs(surest)) surest = at;
    }
    return surest;
  };
  const auto winner = [&](double at) { return at > 0 ? other : one; };
  if (cuts.size() < 2) {
    // Where the border passes through a corner, a side may have lost its cut there.
    double least = 0;
    double greatest = 0;
    for (const Vector2d& corner : polygon) {
      least = std::min(least, gap(corner));
      greatest = std::max(greatest, gap(corner));
    }
    if (cuts.size() == 1 && least < -same_region * size_ && greatest > same_region * size_) return false;
    add(polygon, winner(surest_gap(polygon)));
    return true;
  }
  if (cuts.size() > 2) return false;
  const Polygon first = part_between(cuts[0], cuts[1]);
  const Polygon second = part_between(cuts[1], cuts[0]);
  // The chord leads from the second cut to the first, with `first` on its left.
  const Vector2d& begin = boundary[cuts[1]];
  const Vector2d way = boundary[cuts[0]] - begin;
  const double length = way.norm();
  const bool short_chord = !(length > 1e-9 * size_);
  // A part next to a corner through which the border passes is too small to tell.
  const double at_first = surest_gap(first);
  const double at_second = surest_gap(second);
  const std::int32_t left = std::abs(at_first) > std::abs(at_second) ? winner(at_first) : winner(-at_second);
  const std::int32_t right = left == one ? other : one;
  std::array<Sliver, three_nodes.size()> slivers;
  if (!short_chord) {
    const Vector2d normal(-way.y() / length, way.x() / length);
    for (std::size_t k = 0; k < three_nodes.size(); ++k) {
      const Vector2d base = begin + three_nodes[k] * way;
      double height = 0;
      for (int step = 0; step < max_sliver_steps; ++step) {
        const Vector2d x = base + height * normal;
        const double slope = normal.dot((x - a).normalized() - (x - b).normalized());
        const double change = -gap(x) / slope;
        if (!std::isfinite(change) || std::abs(height + change) > length) return false;
        height += change;
        if (std::abs(change) <= same_region * size_) break;
      }
      if (std::abs(height) > flat_bulge * length) return false;
      slivers[k] = {left, right, base + 0.5 * height * normal, three_weights[k] * height * length};
    }
    slivers_.insert(slivers_.end(), slivers.begin(), slivers.end());
  }
  add(first, left);
  add(second, right);
  return true;
}

}  // namespace supple::voronoi
