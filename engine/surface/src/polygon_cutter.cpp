#include "polygon_cutter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "planar_cross.h"

namespace supple::surface {
namespace {

/// If a triangle of the fan has less quality than this, ears are tried. Corners closer than this to a straight side,
/// relative to the polygon's extent, count as corners on it while other ears remain.
constexpr double min_quality = 1e-6;
/// The fan is replaced only if the worst triangle is better by this factor.
constexpr double min_improvement = 2;
/// Maximum number of times that all corners are examined again, which keeps the cost quadratic. It is needed because
/// the incremental update misses ears of outlines that touch themselves.
constexpr int max_updates = 32;

void write_fan(std::span<Triangle> triangles) {
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(triangles.size()); ++i) triangles[i] = {0, i + 1, i + 2};
}

}  // namespace

// Twice the area, positive if a, b, c turn to the left.
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

// Projects the corners along the normal. Returns false if they enclose no area, so that there is no normal.
bool PolygonCutter::project(std::span<const Eigen::Vector3d> corners) {
  double extent = 0, magnitude = 0;
  for (const auto& p : corners) {
    extent = std::max(extent, (p - corners[0]).cwiseAbs().maxCoeff());
    magnitude = std::max(magnitude, p.cwiseAbs().maxCoeff());
  }
  points_.clear();
  if (!(extent > 0)) return false;
  rounding_height_ = 8 * std::numeric_limits<double>::epsilon() * (1 + magnitude / extent);
  const auto scaled = [&](std::size_t i) -> Eigen::Vector3d { return (corners[i] - corners[0]) / extent; };
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double length = 0;
  for (std::size_t i = 2; i < corners.size(); ++i) {
    normal += scaled(i - 1).cross(scaled(i));
    length += (scaled(i) - scaled(i - 1)).norm();
  }
  if (!(normal.norm() > rounding_height_ * length)) return false;
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
    return (p - corners[0]).cross(along).norm() <= 4 * rounding_height_ * farthest.norm();
  });
}

PolygonCutter::Shape PolygonCutter::fan_shape() const {
  Shape shape{true, 1};
  double total_turn = 0;
  for (Index i = 2; i < static_cast<Index>(points_.size()); ++i) {
    if (!has_area(0, i - 1, i)) return {false, 0};
    shape.worst = std::min(shape.worst, quality(0, i - 1, i));
    const Eigen::Vector2d u = points_[i - 1] - points_[0], v = points_[i] - points_[0];
    total_turn += std::atan2(cross(u, v), u.dot(v));
  }
  shape.covers_once = total_turn < 2 * std::numbers::pi * (1 - 1e-12);
  return shape;
}

bool PolygonCutter::crosses_itself() const {
  const Index n = static_cast<Index>(points_.size());
  for (Index i = 0; i < n; ++i) {
    const Eigen::Vector2d &a = points_[i], &b = points_[(i + 1) % n];
    const Eigen::Vector2d lower = a.cwiseMin(b), upper = a.cwiseMax(b), along = b - a;
    const double margin = rounding_height_ * along.norm();
    for (Index j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;  // neighbours
      const Eigen::Vector2d &c = points_[j], &d = points_[(j + 1) % n];
      if (std::max(c[0], d[0]) < lower[0] || std::min(c[0], d[0]) > upper[0] || std::max(c[1], d[1]) < lower[1] ||
          std::min(c[1], d[1]) > upper[1]) {
        continue;
      }
      const double c_side = cross(along, c - a), d_side = cross(along, d - a);
      if (!(std::min(c_side, d_side) < -margin && std::max(c_side, d_side) > margin)) continue;
      const double a_side = cross(d - c, a - c), b_side = cross(d - c, b - c),
                   other = rounding_height_ * (d - c).norm();
      if (std::min(a_side, b_side) < -other && std::max(a_side, b_side) > other) return true;
    }
  }
  return false;
}

// Whether a side of q, which coincides with the triangle's corner `apex`, points into the triangle.
bool PolygonCutter::points_into(Index q, Index apex, Index first, Index second) const {
  const Eigen::Vector2d u = points_[first] - points_[apex], v = points_[second] - points_[apex];
  for (const Index end : {previous_[q], next_[q]}) {
    const Eigen::Vector2d d = points_[end] - points_[q];
    if (cross(u, d) > rounding_height_ * u.norm() && cross(d, v) > rounding_height_ * v.norm()) return true;
  }
  return false;
}

bool PolygonCutter::blocks(Index q, Index p, Index c, Index n) const {
  if (points_[q] == points_[p]) return points_into(q, p, c, n);
  if (points_[q] == points_[c]) return points_into(q, c, n, p);
  if (points_[q] == points_[n]) return points_into(q, n, p, c);
  const double margin = criterion_ <= EarCriterion::clear_border ? -tolerance_ : tolerance_;
  const auto inside = [&](Index a, Index b) {
    return doubled_area(a, b, q) > margin * (points_[b] - points_[a]).norm();
  };
  return inside(n, p) && inside(p, c) && inside(c, n);
}

double PolygonCutter::ear_quality(Index c) const {
  const Index p = previous_[c], n = next_[c];
  // A side without length, or one that is traversed in both directions, always costs a triangle without area. It is
  // clipped at once, before it affects other ears.
  if (points_[p] == points_[c] || points_[c] == points_[n] || points_[p] == points_[n]) {
    return std::numeric_limits<double>::infinity();
  }
  if (!has_area(p, c, n)) return criterion_ == EarCriterion::no_area && !has_area(n, c, p) ? 0 : -1;
  const Eigen::Vector2d lower = points_[p].cwiseMin(points_[c]).cwiseMin(points_[n]).array() - tolerance_;
  const Eigen::Vector2d upper = points_[p].cwiseMax(points_[c]).cwiseMax(points_[n]).array() + tolerance_;
  for (const Index q : reflex_) {
    const Eigen::Vector2d& at = points_[q];
    if (at[0] < lower[0] || at[0] > upper[0] || at[1] < lower[1] || at[1] > upper[1]) continue;
    if (q != p && q != c && q != n && blocks(q, p, c, n)) return -1;
  }
  return quality(p, c, n);
}

// Examines all remaining corners, beginning at `corner`.
void PolygonCutter::update_ears(std::size_t remaining, Index corner) {
  reflex_.clear();
  for (std::size_t i = 0; i < remaining; ++i, corner = next_[corner]) {
    if (!has_area(previous_[corner], corner, next_[corner])) reflex_.push_back(corner);
  }
  for (std::size_t i = 0; i < remaining; ++i, corner = next_[corner]) qualities_[corner] = ear_quality(corner);
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
  criterion_ = EarCriterion::not_thin;
  tolerance_ = std::max(min_quality, rounding_height_);
  // The remaining corner of least index, so that the result does not depend on the state of the search.
  Index first = 0;
  std::size_t remaining = static_cast<std::size_t>(n), clipped_since_update = 0, count = 0;
  int updates = 0;
  update_ears(remaining, first);
  while (remaining > 3) {
    Index best = first;
    Index c = next_[first];
    for (std::size_t i = 1; i < remaining; ++i, c = next_[c]) {
      if (qualities_[c] > qualities_[best]) best = c;
    }
    if (!(qualities_[best] >= 0)) {
      if (++updates > max_updates) return false;
      if (clipped_since_update == 0) {
        if (criterion_ == EarCriterion::no_area) return false;
        criterion_ = static_cast<EarCriterion>(static_cast<int>(criterion_) + 1);
        tolerance_ = rounding_height_;
      }
      clipped_since_update = 0;
      update_ears(remaining, first);
      continue;
    }
    const Index before = previous_[best], after = next_[best];
    triangles[count++] = {before, best, after};
    next_[before] = after;
    previous_[after] = before;
    if (best == first) first = after;
    --remaining;
    ++clipped_since_update;
    std::erase_if(reflex_, [&](Index q) {
      return q == best || ((q == before || q == after) && has_area(previous_[q], q, next_[q]));
    });
    qualities_[before] = ear_quality(before);
    qualities_[after] = ear_quality(after);
  }
  const Index a = first, b = next_[a], c = next_[b];
  triangles[count] = {a, b, c};
  tolerance_ = rounding_height_;
  return !has_area(a, c, b);
}

PolygonCutter::Outcome PolygonCutter::cut(std::span<const Eigen::Vector3d> corners, std::span<Triangle> triangles) {
  write_fan(triangles);
  if (!std::all_of(corners.begin(), corners.end(), [](const auto& p) { return p.allFinite(); })) return Outcome::cut;
  if (!project(corners)) return is_line(corners) ? Outcome::cut : Outcome::crosses_itself;
  tolerance_ = rounding_height_;
  const Shape fan = fan_shape();
  if (fan.covers_once && fan.worst > min_quality) return Outcome::cut;
  if (corners.size() > max_corners) return fan.covers_once ? Outcome::cut : Outcome::too_many_corners;
  const bool clipped = (fan.covers_once || !crosses_itself()) && clip_ears(triangles);
  double worst = 1;
  for (const auto& [a, b, c] : triangles) worst = std::min(worst, quality(a, b, c));
  if (fan.covers_once && !(clipped && worst > min_improvement * fan.worst)) {
    write_fan(triangles);
    return Outcome::cut;
  }
  if (clipped) return Outcome::cut;
  write_fan(triangles);
  return Outcome::crosses_itself;
}

}  // namespace supple::surface
