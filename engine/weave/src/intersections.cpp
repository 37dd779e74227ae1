#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "curve_intersections.h"
#include "piece_tree.h"

namespace supple::weave {
namespace {

constexpr int max_newton_iterations = 20;
/// Coordinates are equal within this fraction of the curve's length. Tangents are parallel below this sine of their
/// angle.
constexpr double coordinate_tolerance = 1e-9;
/// Maximum difference of the coordinates of equal intersections, as a fraction of the length, on both curves.
constexpr double same_intersection = 10 * coordinate_tolerance;
/// Maximum distance between the two points of a solution, as a fraction of the sum of the curves' lengths.
constexpr double max_separation = 1e-11;
/// Fraction of its length by which an iterate may leave a piece before the search is left to the neighbouring piece.
constexpr double max_overshoot = 0.5;
/// Up to this many intersections are compared one by one instead of by the grid.
constexpr std::size_t max_linear_search = 16;

/// Moves a coordinate of a solution into the curve's range. Returns false if it lies outside.
bool move_into_range(const StrandCurve& curve, double& s) {
  const double tolerance = coordinate_tolerance * curve.length();
  if (curve.ends() == Ends::open) {
    if (s < -tolerance || s > curve.length() + tolerance) return false;
    s = std::clamp(s, 0.0, curve.length());
    return true;
  }
  // Only coordinates of the first period count: other copies of the curve are searched with other shifts.
  if (curve.ends() == Ends::periodic)
    return s >= -tolerance && s < curve.length() - tolerance && ((s = std::max(s, 0.0)), true);
  s -= curve.length() * std::floor((s + tolerance) / curve.length());
  s = std::max(s, 0.0);
  return true;
}

}  // namespace

double CurveIntersections::Range::overshoot() const { return max_overshoot * (end - begin); }

std::size_t CurveIntersections::add_pieces(std::size_t i, std::size_t j) {
  // A line can intersect a piece twice: the start at each end leads to one of the two.
  constexpr std::array<std::array<double, 2>, 5> starts{{{0.5, 0.5}, {0, 0}, {1, 1}, {0, 1}, {1, 0}}};
  const std::size_t before = found_.size();
  const Range on_first{first_.knots()[i], first_.knots()[i + 1]};
  const Range on_second{second_.knots()[j], second_.knots()[j + 1]};
  for (const auto& start : starts)
    if (auto solution = newton(on_first, on_second, start[0], start[1])) add_if_new(*solution);
  // From the middle of a piece that is much longer than the other one, the first step leaves the shorter piece. The
  // start on the longer piece is then the point nearest to the shorter one.
  constexpr double uneven_ratio = 4;
  const double lengths[] = {on_first.end - on_first.begin, on_second.end - on_second.begin};
  if (lengths[0] > uneven_ratio * lengths[1]) {
    const Eigen::Vector2d middle = second_.at(on_second.begin + lengths[1] / 2).position + shift_;
    if (auto solution = newton(on_first, on_second, nearest_fraction(first_, on_first, middle), 0.5))
      add_if_new(*solution);
  } else if (lengths[1] > uneven_ratio * lengths[0]) {
    const Eigen::Vector2d middle = first_.at(on_first.begin + lengths[0] / 2).position - shift_;
    if (auto solution = newton(on_first, on_second, 0.5, nearest_fraction(second_, on_second, middle)))
      add_if_new(*solution);
  }
  return found_.size() - before;
}

/// Approximate fraction of the piece at which the curve is nearest to a point.
double CurveIntersections::nearest_fraction(const StrandCurve& curve, const Range& range,
                                            const Eigen::Vector2d& point) {
  constexpr int iterations = 3;
  double fraction = 0.5;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const auto there = curve.at(range.begin + fraction * (range.end - range.begin));
    const double along = there.first.dot(point - there.position) / there.first.squaredNorm();
    fraction = std::clamp(fraction + along / (range.end - range.begin), 0.0, 1.0);
  }
  return fraction;
}

std::vector<Intersection> CurveIntersections::take_sorted() {
  std::sort(found_.begin(), found_.end(),
            [](const Intersection& a, const Intersection& b) { return a.first < b.first; });
  cells_.clear();
  return std::exchange(found_, {});
}

std::optional<Intersection> CurveIntersections::newton(const Range& r1, const Range& r2, double a, double b) const {
  double s = r1.begin + a * (r1.end - r1.begin);
  double t = r2.begin + b * (r2.end - r2.begin);
  for (int iteration = 0; iteration < max_newton_iterations; ++iteration) {
    const auto p = first_.at(s);
    const auto q = second_.at(t);
    const Eigen::Vector2d separation = q.position + shift_ - p.position;
    Eigen::Matrix2d tangents;
    tangents << p.first, -q.first;
    const double sine = tangents.determinant();
    if (separation.norm() <= max_separation * (first_.length() + second_.length())) {
      if (std::abs(sine) < coordinate_tolerance) return std::nullopt;
      return Intersection{s, t, std::asin(std::min(1.0, std::abs(sine) / (p.first.norm() * q.first.norm())))};
    }
    const Eigen::Vector2d step = tangents.inverse() * separation;
    s += step[0];
    t += step[1];
    if (!r1.allows(s) || !r2.allows(t)) return std::nullopt;
  }
  return std::nullopt;
}

bool CurveIntersections::is_same(const Intersection& a, const Intersection& b) const {
  return std::abs(a.first - b.first) <= same_intersection * first_.length() &&
         std::abs(a.second - b.second) <= same_intersection * second_.length();
}

/// The grid cell of a pair of coordinates. 1 / same_intersection cells along a curve are less than 2^32.
std::uint64_t CurveIntersections::cell(double first, double second) const {
  const auto count = [](double coordinate, double length) {
    return static_cast<std::uint64_t>(std::max(0.0, coordinate / (same_intersection * length)) + 1);
  };
  return count(first, first_.length()) << 32U | count(second, second_.length());
}

bool CurveIntersections::is_known(const Intersection& found) const {
  if (cells_.empty())
    return std::any_of(found_.begin(), found_.end(), [&](const Intersection& other) { return is_same(other, found); });
  const std::uint64_t middle = cell(found.first, found.second);
  for (std::uint64_t row = 0; row < 3; ++row) {
    for (std::uint64_t column = 0; column < 3; ++column) {
      // The index of a cell is at least 1, so that each cell has one before it.
      const auto [begin, end] = cells_.equal_range(middle + ((row << 32U) + column) - ((1ULL << 32U) + 1));
      for (auto other = begin; other != end; ++other)
        if (is_same(found_[other->second], found)) return true;
    }
  }
  return false;
}

void CurveIntersections::add_if_new(Intersection found) {
  if (!move_into_range(first_, found.first) || !move_into_range(second_, found.second) || is_known(found)) return;
  found_.push_back(found);
  if (found_.size() <= max_linear_search) return;
  for (std::size_t k = cells_.size(); k < found_.size(); ++k)
    cells_.emplace(cell(found_[k].first, found_[k].second), static_cast<std::uint32_t>(k));
}

std::vector<Intersection> intersections(const StrandCurve& first, const StrandCurve& second,
                                        const Eigen::Vector2d& shift) {
  const PieceTree tree({{second, 1}}, {});
  const std::vector<Eigen::AlignedBox2d> boxes = piece_boxes(first);
  CurveIntersections found(first, second, shift);
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    near.clear();
    tree.for_each_near(boxes[i], shift, 0, [&near](std::int32_t, std::int32_t piece, const Eigen::AlignedBox2d&) {
      near.push_back(static_cast<std::size_t>(piece));
    });
    std::sort(near.begin(), near.end());
    for (const std::size_t j : near) found.add_pieces(i, j);
  }
  return found.take_sorted();
}

}  // namespace supple::weave
