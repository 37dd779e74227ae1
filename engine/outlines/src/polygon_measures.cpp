#include "polygon_measures.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace supple::outlines {
namespace {

double distance_to_side(const Point& p, const Point& a, const Point& b) {
  const Point along = b - a;
  const double squared = along.squaredNorm();
  const double t = squared > 0 ? std::clamp((p - a).dot(along) / squared, 0.0, 1.0) : 0.0;
  return (p - a - t * along).norm();
}

/// Whether each point lies within a distance of the polyline: one after another, from the side of the one before.
bool lie_on(const Points& points, const Points& line, double distance, bool closed) {
  const std::size_t sides = line.size() - (closed ? 0 : 1);
  std::size_t side = 0;
  for (const Point& p : points) {
    std::size_t tries = 0;
    // Where the curves run side by side the next side is near the last one, in either direction.
    while (tries < sides) {
      const std::size_t step = (tries + 1) / 2;
      const std::size_t k = (tries % 2 == 0 ? side + step : side + sides - step) % sides;
      if (distance_to_side(p, line[k], line[(k + 1) % line.size()]) <= distance) {
        side = k;
        break;
      }
      ++tries;
    }
    if (tries == sides) return false;
  }
  return true;
}

double cross(const Point& a, const Point& b, const Point& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

struct Side {
  std::size_t polygon, index;
  Point a, b;
  double left, right, bottom, top;
};

bool touch(const Side& s, const Side& t, double distance) {
  const double d1 = cross(s.a, s.b, t.a), d2 = cross(s.a, s.b, t.b);
  const double d3 = cross(t.a, t.b, s.a), d4 = cross(t.a, t.b, s.b);
  if (((d1 > 0) != (d2 > 0)) && ((d3 > 0) != (d4 > 0))) return true;
  return distance_to_side(t.a, s.a, s.b) <= distance || distance_to_side(t.b, s.a, s.b) <= distance ||
         distance_to_side(s.a, t.a, t.b) <= distance || distance_to_side(s.b, t.a, t.b) <= distance;
}

}  // namespace

Box box_of(const Points& points) {
  Box box;
  box.include(points);
  return box;
}

double area_of(const Points& points) {
  double twice = 0;
  for (std::size_t k = 1; k + 1 < points.size(); ++k) {
    const Point a = points[k] - points[0], b = points[k + 1] - points[0];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

bool is_inside(const Points& polygon, const Point& p) {
  bool inside = false;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      inside = !inside;
  }
  return inside;
}

bool is_same_curve(const Points& a, const Points& b, double distance, bool closed) {
  const Box first = box_of(a), second = box_of(b);
  if ((first.lower - second.lower).cwiseAbs().maxCoeff() > distance ||
      (first.upper - second.upper).cwiseAbs().maxCoeff() > distance)
    return false;
  if (!closed) {
    const auto near = [distance](const Point& p, const Point& q) { return (p - q).norm() <= distance; };
    if (!(near(a.front(), b.front()) && near(a.back(), b.back())) &&
        !(near(a.front(), b.back()) && near(a.back(), b.front())))
      return false;
  }
  return lie_on(a, b, distance, closed) && lie_on(b, a, distance, closed);
}

Points simplified(const Points& polygon, double distance) {
  const std::size_t n = polygon.size();
  if (n < 4) return polygon;
  // The two corners that are kept in any case: the first, and the farthest from it.
  std::size_t far = 0;
  for (std::size_t k = 1; k < n; ++k) {
    if ((polygon[k] - polygon[0]).squaredNorm() > (polygon[far] - polygon[0]).squaredNorm()) far = k;
  }
  std::vector<bool> kept(n + 1, false);
  kept[0] = kept[far] = kept[n] = true;
  std::vector<std::pair<std::size_t, std::size_t>> spans{{0, far}, {far, n}};
  while (!spans.empty()) {
    const auto [from, to] = spans.back();
    spans.pop_back();
    double most = distance;
    std::size_t at = 0;
    for (std::size_t k = from + 1; k < to; ++k) {
      const double off = distance_to_side(polygon[k], polygon[from], polygon[to % n]);
      if (off <= most) continue;
      most = off;
      at = k;
    }
    if (at == 0) continue;
    kept[at] = true;
    spans.emplace_back(from, at);
    spans.emplace_back(at, to);
  }
  Points result;
  for (std::size_t k = 0; k < n; ++k) {
    if (kept[k]) result.push_back(polygon[k]);
  }
  return result;
}

void drop_repeated(Points& points, double least) {
  Points kept;
  for (const Point& p : points) {
    if (kept.empty() || (p - kept.back()).norm() > least) kept.push_back(p);
  }
  while (kept.size() > 1 && (kept.front() - kept.back()).norm() <= least) kept.pop_back();
  points = std::move(kept);
}

std::vector<std::pair<std::size_t, std::size_t>> contacts(const std::vector<const Points*>& polygons, double distance,
                                                          const Execution& execution) {
  constexpr std::size_t sides_between_checks = 1'024;
  std::vector<Side> sides;
  double bottom = INFINITY, top = -INFINITY;
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    const Points& points = *polygons[i];
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Point &a = points[k], &b = points[(k + 1) % points.size()];
      sides.push_back({i, k, a, b, std::min(a.x(), b.x()) - distance, std::max(a.x(), b.x()) + distance,
                       std::min(a.y(), b.y()) - distance, std::max(a.y(), b.y()) + distance});
      bottom = std::min(bottom, sides.back().bottom);
      top = std::max(top, sides.back().top);
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& s, const Side& t) { return s.left < t.left; });
  std::set<std::pair<std::size_t, std::size_t>> found;
  const auto strips = static_cast<std::size_t>(std::max(1.0, std::sqrt(static_cast<double>(sides.size()))));
  const double height = std::max((top - bottom) / static_cast<double>(strips), 1e-300);
  const auto strip_of = [&](double y) {
    return static_cast<std::size_t>(std::clamp((y - bottom) / height, 0.0, static_cast<double>(strips - 1)));
  };
  std::vector<std::vector<std::size_t>> active(strips);
  for (std::size_t k = 0; k < sides.size(); ++k) {
    if (k % sides_between_checks == 0) execution.cancellation.throw_if_requested();
    const Side& side = sides[k];
    for (std::size_t strip = strip_of(side.bottom); strip <= strip_of(side.top); ++strip) {
      std::erase_if(active[strip], [&](std::size_t other) { return sides[other].right < side.left; });
      for (const std::size_t at : active[strip]) {
        const Side& other = sides[at];
        if (other.top < side.bottom || other.bottom > side.top) continue;
        const auto pair = std::minmax(side.polygon, other.polygon);
        if (side.polygon == other.polygon) {
          const std::size_t n = polygons[side.polygon]->size();
          const std::size_t apart = (side.index + n - other.index) % n;
          if (apart <= 1 || apart == n - 1) continue;
        }
        if (!found.contains(pair) && touch(side, other, distance)) found.insert(pair);
      }
      active[strip].push_back(k);
    }
  }
  return {found.begin(), found.end()};
}

}  // namespace supple::outlines
