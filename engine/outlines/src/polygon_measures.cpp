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

/// Whether each point lies within a distance of the polyline. The search begins at the side found for the point before.
bool lie_on(const Points& points, const Points& line, double distance, bool closed) {
  const std::size_t sides = line.size() - (closed ? 0 : 1);
  std::size_t side = 0;
  for (const Point& p : points) {
    std::size_t tries = 0;
    // If the curves run side by side, the next side is near the last one, in either direction.
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

/// A side of a polygon, from one corner to the next.
struct Side {
  std::size_t polygon, index;
  Point a, b;
};

bool touch(const Side& s, const Side& t, double distance) {
  const double d1 = cross(s.a, s.b, t.a), d2 = cross(s.a, s.b, t.b);
  const double d3 = cross(t.a, t.b, s.a), d4 = cross(t.a, t.b, s.b);
  if (((d1 > 0) != (d2 > 0)) && ((d3 > 0) != (d4 > 0))) return true;
  return distance_to_side(t.a, s.a, s.b) <= distance || distance_to_side(t.b, s.a, s.b) <= distance ||
         distance_to_side(s.a, t.a, t.b) <= distance || distance_to_side(s.b, t.a, t.b) <= distance;
}

Box widened(Box box, double distance) {
  box.lower.array() -= distance;
  box.upper.array() += distance;
  return box;
}

bool overlap(const Box& a, const Box& b) {
  return a.lower.x() <= b.upper.x() && b.lower.x() <= a.upper.x() && a.lower.y() <= b.upper.y() &&
         b.lower.y() <= a.upper.y();
}

Box intersection(const Box& a, const Box& b) { return {a.lower.cwiseMax(b.lower), a.upper.cwiseMin(b.upper)}; }

/// Calls visit(i, j) for each pair of boxes that overlap, until it returns false: a sweep from left to right, in
/// horizontal strips. About O(n sqrt(n)) if few of them overlap.
template <class Visit>
void for_each_overlap(const std::vector<Box>& boxes, const Execution& execution, const Visit& visit) {
  constexpr std::size_t max_boxes_in_pairs = 40, boxes_between_checks = 1'024;
  if (boxes.size() <= max_boxes_in_pairs) {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (overlap(boxes[i], boxes[j]) && !visit(j, i)) return;
      }
    }
    return;
  }
  std::vector<std::pair<double, std::size_t>> order;
  order.reserve(boxes.size());
  Box whole;
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    order.emplace_back(boxes[k].lower.x(), k);
    whole.include(boxes[k]);
  }
  std::sort(order.begin(), order.end());
  const auto strips = static_cast<std::size_t>(std::sqrt(static_cast<double>(boxes.size())));
  const double bottom = whole.lower.y();
  const double height = std::max((whole.upper.y() - bottom) / static_cast<double>(strips), 1e-300);
  const auto strip_of = [&](double y) {
    return static_cast<std::size_t>(std::clamp((y - bottom) / height, 0.0, static_cast<double>(strips - 1)));
  };
  std::vector<std::vector<std::size_t>> active(strips);
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k % boxes_between_checks == 0) execution.cancellation.throw_if_requested();
    const std::size_t own = order[k].second;
    const Box& box = boxes[own];
    const std::size_t first = strip_of(box.lower.y()), last = strip_of(box.upper.y());
    for (std::size_t strip = first; strip <= last; ++strip) {
      std::vector<std::size_t>& others = active[strip];
      std::size_t retained = 0;
      bool continues = true;
      for (const std::size_t other : others) {
        if (boxes[other].upper.x() < box.lower.x()) continue;
        others[retained++] = other;
        // A pair that lies in several strips is visited in the first of them.
        if (continues && overlap(box, boxes[other]) && strip == std::max(first, strip_of(boxes[other].lower.y())))
          continues = visit(other, own);
      }
      if (!continues) return;
      others.resize(retained);
      others.push_back(own);
    }
  }
}

Box box_of_side(const Point& a, const Point& b, double distance) {
  return widened({a.cwiseMin(b), a.cwiseMax(b)}, distance);
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
  // Two corners are always retained: the first one, and the one farthest from it.
  std::size_t opposite = 0;
  for (std::size_t k = 1; k < n; ++k) {
    if ((polygon[k] - polygon[0]).squaredNorm() > (polygon[opposite] - polygon[0]).squaredNorm()) opposite = k;
  }
  std::vector<bool> is_retained(n + 1, false);
  is_retained[0] = is_retained[opposite] = is_retained[n] = true;
  std::vector<std::pair<std::size_t, std::size_t>> spans{{0, opposite}, {opposite, n}};
  while (!spans.empty()) {
    const auto [from, to] = spans.back();
    spans.pop_back();
    double max_deviation = distance;
    std::size_t farthest = 0;
    for (std::size_t k = from + 1; k < to; ++k) {
      const double deviation = distance_to_side(polygon[k], polygon[from], polygon[to % n]);
      if (deviation <= max_deviation) continue;
      max_deviation = deviation;
      farthest = k;
    }
    if (farthest == 0) continue;
    is_retained[farthest] = true;
    spans.emplace_back(from, farthest);
    spans.emplace_back(farthest, to);
  }
  Points result;
  for (std::size_t k = 0; k < n; ++k) {
    if (is_retained[k]) result.push_back(polygon[k]);
  }
  return result;
}

void drop_repeated(Points& points, double min_distance) {
  std::size_t retained = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (retained == 0 || (points[k] - points[retained - 1]).norm() > min_distance) points[retained++] = points[k];
  }
  while (retained > 1 && (points.front() - points[retained - 1]).norm() <= min_distance) --retained;
  points.resize(retained);
}

bool touches_itself(const Points& polygon, double distance, const Execution& execution) {
  const std::size_t n = polygon.size();
  std::vector<Box> boxes;
  boxes.reserve(n);
  for (std::size_t k = 0; k < n; ++k) boxes.push_back(box_of_side(polygon[k], polygon[(k + 1) % n], distance));
  const auto side = [&](std::size_t k) { return Side{0, k, polygon[k], polygon[(k + 1) % n]}; };
  bool found = false;
  for_each_overlap(boxes, execution, [&](std::size_t i, std::size_t j) {
    const std::size_t index_distance = i < j ? j - i : i - j;
    found = index_distance > 1 && index_distance + 1 < n && touch(side(i), side(j), distance);
    return !found;
  });
  return found;
}

std::vector<std::pair<std::size_t, std::size_t>> contacts(const std::vector<const Points*>& polygons,
                                                          const std::vector<std::size_t>& owners, double distance,
                                                          const Execution& execution) {
  std::vector<Box> boxes;
  boxes.reserve(polygons.size());
  for (const Points* points : polygons) boxes.push_back(widened(box_of(*points), distance));
  // Sides can touch only where the boxes of their polygons overlap.
  std::vector<Box> overlaps(polygons.size());
  for_each_overlap(boxes, execution, [&](std::size_t i, std::size_t j) {
    if (owners[i] == owners[j]) return true;
    const Box part = intersection(boxes[i], boxes[j]);
    overlaps[i].include(part);
    overlaps[j].include(part);
    return true;
  });
  std::vector<Side> sides;
  std::vector<Box> boxes_of_sides;
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    if (!(overlaps[i].lower.x() <= overlaps[i].upper.x())) continue;
    const Points& points = *polygons[i];
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Point &a = points[k], &b = points[(k + 1) % points.size()];
      const Box box = box_of_side(a, b, distance);
      if (!overlap(box, overlaps[i])) continue;
      sides.push_back({i, k, a, b});
      boxes_of_sides.push_back(box);
    }
  }
  std::set<std::pair<std::size_t, std::size_t>> found;
  for_each_overlap(boxes_of_sides, execution, [&](std::size_t i, std::size_t j) {
    if (owners[sides[i].polygon] == owners[sides[j].polygon]) return true;
    const auto pair = std::minmax(sides[i].polygon, sides[j].polygon);
    if (!found.contains(pair) && touch(sides[i], sides[j], distance)) found.insert(pair);
    return true;
  });
  return {found.begin(), found.end()};
}

}  // namespace supple::outlines
