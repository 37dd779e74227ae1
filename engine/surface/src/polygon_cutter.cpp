#include "polygon_cutter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "planar_cross.h"

namespace supple::surface {
namespace {

/// A fan with a triangle of less quality than this is a reason to look for a better cut. Corners that are off a
/// straight side by less, in units of the polygon's extent, count as corners on it as long as that leaves ears.
constexpr double thin = 1e-6;
/// The fan is given up for a cut whose worst triangle is better by this factor.
constexpr double much_better = 2;
/// Outlines that touch themselves may hide ears from the bookkeeping, which then looks at all corners anew: so often at
/// most, to keep the cost quadratic.
constexpr int most_refreshes = 32;

void write_fan(std::span<Triangle> triangles) {
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(triangles.size()); ++i) triangles[i] = {0, i + 1, i + 2};
}

}  // namespace

// Twice the area, positive where a, b, c turn to the left.
double PolygonCutter::doubled_area(Index a, Index b, Index c) const {
  return cross(points_[b] - points_[a], points_[c] - points_[a]);
}

// 1 for an equilateral triangle, 0 for one without area, negative for one that turns to the right.
double PolygonCutter::quality(Index a, Index b, Index c) const {
  const double squares = (points_[b] - points_[a]).squaredNorm() + (points_[c] - points_[b]).squaredNorm() +
                         (points_[a] - points_[c]).squaredNorm();
  return squares > 0 ? 2 * std::numbers::sqrt3 * doubled_area(a, b, c) / squares : 0;
}

bool PolygonCutter::has_area(Index a, Index b, Index c) const {
  const double longest = std::max({(points_[b] - points_[a]).squaredNorm(), (points_[c] - points_[b]).squaredNorm(),
                                   (points_[a] - points_[c]).squaredNorm()});
  return doubled_area(a, b, c) > tolerance_ * std::sqrt(longest);
}

// Whether the corners enclose an area: without one there is no side to see them from.
bool PolygonCutter::project(std::span<const Eigen::Vector3d> corners) {
  double extent = 0, magnitude = 0;
  for (const auto& p : corners) {
    extent = std::max(extent, (p - corners[0]).cwiseAbs().maxCoeff());
    magnitude = std::max(magnitude, p.cwiseAbs().maxCoeff());
  }
  points_.clear();
  if (!(extent > 0)) return false;
  flat_ = 8 * std::numeric_limits<double>::epsilon() * (1 + magnitude / extent);
  const auto scaled = [&](std::size_t i) -> Eigen::Vector3d { return (corners[i] - corners[0]) / extent; };
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double length = 0;
  for (std::size_t i = 2; i < corners.size(); ++i) {
    normal += scaled(i - 1).cross(scaled(i));
    length += (scaled(i) - scaled(i - 1)).norm();
  }
  if (!(normal.norm() > flat_ * length)) return false;
  normal.normalize();
  const Eigen::Vector3d first = normal.unitOrthogonal(), second = normal.cross(first);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d p = scaled(i);
    points_.emplace_back(first.dot(p), second.dot(p));
  }
  return true;
}

bool PolygonCutter::is_line(std::span<const Eigen::Vector3d> corners) const {
  Eigen::Vector3d farthest = Eigen::Vector3d::Zero();
  for (const auto& p : corners) {
    if ((p - corners[0]).squaredNorm() > farthest.squaredNorm()) farthest = p - corners[0];
  }
  if (!(farthest.norm() > 0)) return true;
  const Eigen::Vector3d along = farthest.normalized();
  return std::all_of(corners.begin(), corners.end(), [&](const Eigen::Vector3d& p) {
    return (p - corners[0]).cross(along).norm() <= 4 * flat_ * farthest.norm();
  });
}

PolygonCutter::Shape PolygonCutter::fan_shape() const {
  Shape shape{true, 1};
  double turned = 0;
  for (Index i = 2; i < static_cast<Index>(points_.size()); ++i) {
    if (!has_area(0, i - 1, i)) return {false, 0};
    shape.worst = std::min(shape.worst, quality(0, i - 1, i));
    const Eigen::Vector2d u = points_[i - 1] - points_[0], v = points_[i] - points_[0];
    turned += std::atan2(cross(u, v), u.dot(v));
  }
  shape.covers_once = turned < 2 * std::numbers::pi * (1 - 1e-12);
  return shape;
}

bool PolygonCutter::crosses_itself() const {
  const Index n = static_cast<Index>(points_.size());
  for (Index i = 0; i < n; ++i) {
    const Eigen::Vector2d &a = points_[i], &b = points_[(i + 1) % n];
    const Eigen::Vector2d lower = a.cwiseMin(b), upper = a.cwiseMax(b), along = b - a;
    const double margin = flat_ * along.norm();
    for (Index j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;  // neighbours
      const Eigen::Vector2d &c = points_[j], &d = points_[(j + 1) % n];
      if (std::max(c[0], d[0]) < lower[0] || std::min(c[0], d[0]) > upper[0] || std::max(c[1], d[1]) < lower[1] ||
          std::min(c[1], d[1]) > upper[1]) {
        continue;
      }
      const double c_side = cross(along, c - a), d_side = cross(along, d - a);
      if (!(std::min(c_side, d_side) < -margin && std::max(c_side, d_side) > margin)) continue;
      const double a_side = cross(d - c, a - c), b_side = cross(d - c, b - c), other = flat_ * (d - c).norm();
      if (std::min(a_side, b_side) < -other && std::max(a_side, b_side) > other) return true;
    }
  }
  return false;
}

// Whether a side of q, which lies where the triangle's corner `apex` does, leads into the triangle.
bool PolygonCutter::leads_into(Index q, Index apex, Index first, Index second) const {
  const Eigen::Vector2d u = points_[first] - points_[apex], v = points_[second] - points_[apex];
  for (const Index end : {previous_[q], next_[q]}) {
    const Eigen::Vector2d d = points_[end] - points_[q];
    if (cross(u, d) > flat_ * u.norm() && cross(d, v) > flat_ * v.norm()) return true;
  }
  return false;
}

bool PolygonCutter::blocks(Index q, Index p, Index c, Index n) const {
  if (points_[q] == points_[p]) return leads_into(q, p, c, n);
  if (points_[q] == points_[c]) return leads_into(q, c, n, p);
  if (points_[q] == points_[n]) return leads_into(q, n, p, c);
  const double margin = allowed_ <= Allowed::clear_border ? -tolerance_ : tolerance_;
  const auto inside = [&](Index a, Index b) {
    return doubled_area(a, b, q) > margin * (points_[b] - points_[a]).norm();
  };
  return inside(n, p) && inside(p, c) && inside(c, n);
}

double PolygonCutter::ear_quality(Index c) const {
  const Index p = previous_[c], n = next_[c];
  // A side without length, or one that is walked forth and back, costs a triangle without area whatever is done: at
  // once, before it confuses the others.
  if (points_[p] == points_[c] || points_[c] == points_[n] || points_[p] == points_[n]) {
    return std::numeric_limits<double>::infinity();
  }
  if (!has_area(p, c, n)) return allowed_ == Allowed::no_area && !has_area(n, c, p) ? 0 : -1;
  const Eigen::Vector2d lower = points_[p].cwiseMin(points_[c]).cwiseMin(points_[n]).array() - tolerance_;
  const Eigen::Vector2d upper = points_[p].cwiseMax(points_[c]).cwiseMax(points_[n]).array() + tolerance_;
  for (const Index q : reflex_) {
    const Eigen::Vector2d& at = points_[q];
    if (at[0] < lower[0] || at[0] > upper[0] || at[1] < lower[1] || at[1] > upper[1]) continue;
    if (q != p && q != c && q != n && blocks(q, p, c, n)) return -1;
  }
  return quality(p, c, n);
}

// Looks at all corners that are left, `some` being one of them.
void PolygonCutter::refresh(std::size_t left, Index some) {
  reflex_.clear();
  for (std::size_t i = 0; i < left; ++i, some = next_[some]) {
    if (!has_area(previous_[some], some, next_[some])) reflex_.push_back(some);
  }
  for (std::size_t i = 0; i < left; ++i, some = next_[some]) qualities_[some] = ear_quality(some);
}

bool PolygonCutter::clip_ears(std::span<Triangle> triangles) {
  const Index n = static_cast<Index>(points_.size());
  previous_.resize(n);
  next_.resize(n);
  qualities_.resize(n);
  for (Index i = 0; i < n; ++i) {
    previous_[i] = (i + n - 1) % n;
    next_[i] = (i + 1) % n;
  }
  allowed_ = Allowed::not_thin;
  tolerance_ = std::max(thin, flat_);
  Index first = 0;  // the least corner that is left: the result does not depend on where the search stood
  std::size_t left = static_cast<std::size_t>(n), since_refresh = 0, count = 0;
  int refreshes = 0;
  refresh(left, first);
  while (left > 3) {
    Index best = first;
    Index c = next_[first];
    for (std::size_t i = 1; i < left; ++i, c = next_[c]) {
      if (qualities_[c] > qualities_[best]) best = c;
    }
    if (!(qualities_[best] >= 0)) {
      if (++refreshes > most_refreshes) return false;
      if (since_refresh == 0) {
        if (allowed_ == Allowed::no_area) return false;
        allowed_ = static_cast<Allowed>(static_cast<int>(allowed_) + 1);
        tolerance_ = flat_;
      }
      since_refresh = 0;
      refresh(left, first);
      continue;
    }
    const Index before = previous_[best], after = next_[best];
    triangles[count++] = {before, best, after};
    next_[before] = after;
    previous_[after] = before;
    if (best == first) first = after;
    --left;
    ++since_refresh;
    std::erase_if(reflex_, [&](Index q) {
      return q == best || ((q == before || q == after) && has_area(previous_[q], q, next_[q]));
    });
    qualities_[before] = ear_quality(before);
    qualities_[after] = ear_quality(after);
  }
  const Index a = first, b = next_[a], c = next_[b];
  triangles[count] = {a, b, c};
  tolerance_ = flat_;
  return !has_area(a, c, b);
}

PolygonCutter::Outcome PolygonCutter::cut(std::span<const Eigen::Vector3d> corners, std::span<Triangle> triangles) {
  write_fan(triangles);
  if (!std::all_of(corners.begin(), corners.end(), [](const auto& p) { return p.allFinite(); })) return Outcome::cut;
  if (!project(corners)) return is_line(corners) ? Outcome::cut : Outcome::crosses_itself;
  tolerance_ = flat_;
  const Shape fan = fan_shape();
  if (fan.covers_once && fan.worst > thin) return Outcome::cut;
  if (corners.size() > most_corners) return fan.covers_once ? Outcome::cut : Outcome::too_many_corners;
  const bool done = (fan.covers_once || !crosses_itself()) && clip_ears(triangles);
  double worst = 1;
  for (const auto& [a, b, c] : triangles) worst = std::min(worst, quality(a, b, c));
  if (fan.covers_once && !(done && worst > much_better * fan.worst)) {
    write_fan(triangles);
    return Outcome::cut;
  }
  if (done) return Outcome::cut;
  write_fan(triangles);
  return Outcome::crosses_itself;
}

}  // namespace supple::surface
