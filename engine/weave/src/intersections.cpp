#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "curve_meetings.h"
#include "piece_tree.h"

namespace supple::weave {
namespace {

constexpr int newton_rounds = 20;
/// A point lies on a piece's end within this share of a curve's length.
constexpr double same_place = 1e-9;
/// Two solutions are one within this share of both curves' lengths.
constexpr double same_meeting = 10 * same_place;
/// A solution's two positions agree to this share of the lengths.
constexpr double agreement = 1e-11;
/// Steps of Newton's method may leave a piece by this share of it before it is another piece's business.
constexpr double overreach = 0.5;
/// So many are compared one by one.
constexpr std::size_t few_meetings = 16;

/// Moves a coordinate of a solution onto the curve. False where it is not on it.
bool settle(const StrandCurve& curve, double& s) {
  const double slack = same_place * curve.length();
  if (curve.ends() == Ends::open) {
    if (s < -slack || s > curve.length() + slack) return false;
    s = std::clamp(s, 0.0, curve.length());
    return true;
  }
  // Another period's copy is found where that period is asked for.
  if (curve.ends() == Ends::periodic)
    return s >= -slack && s < curve.length() - slack && ((s = std::max(s, 0.0)), true);
  s -= curve.length() * std::floor((s + slack) / curve.length());
  s = std::max(s, 0.0);
  return true;
}

}  // namespace

double CurveMeetings::Range::slack() const { return overreach * (end - begin); }

std::size_t CurveMeetings::add_pieces(std::size_t i, std::size_t j) {
  // A line can cut one piece twice: once from each end.
  constexpr std::array<std::array<double, 2>, 5> starts{{{0.5, 0.5}, {0, 0}, {1, 1}, {0, 1}, {1, 0}}};
  const std::size_t before = found_.size();
  const Range on_first{first_.knots()[i], first_.knots()[i + 1]};
  const Range on_second{second_.knots()[j], second_.knots()[j + 1]};
  for (const auto& start : starts)
    if (auto solution = newton(on_first, on_second, start[0], start[1])) keep(*solution);
  // From the middle of a long piece a step along a much shorter one leaves it: there the start is what lies nearest.
  constexpr double uneven = 4;
  const double lengths[] = {on_first.end - on_first.begin, on_second.end - on_second.begin};
  if (lengths[0] > uneven * lengths[1]) {
    const Eigen::Vector2d middle = second_.at(on_second.begin + lengths[1] / 2).position + shift_;
    if (auto solution = newton(on_first, on_second, nearest(first_, on_first, middle), 0.5)) keep(*solution);
  } else if (lengths[1] > uneven * lengths[0]) {
    const Eigen::Vector2d middle = first_.at(on_first.begin + lengths[0] / 2).position - shift_;
    if (auto solution = newton(on_first, on_second, 0.5, nearest(second_, on_second, middle))) keep(*solution);
  }
  return found_.size() - before;
}

/// The share of the piece at which the curve is nearest to a point, about.
double CurveMeetings::nearest(const StrandCurve& curve, const Range& range, const Eigen::Vector2d& point) {
  constexpr int rounds = 3;
  double share = 0.5;
  for (int round = 0; round < rounds; ++round) {
    const auto there = curve.at(range.begin + share * (range.end - range.begin));
    const double along = there.first.dot(point - there.position) / there.first.squaredNorm();
    share = std::clamp(share + along / (range.end - range.begin), 0.0, 1.0);
  }
  return share;
}

std::vector<Intersection> CurveMeetings::take_sorted() {
  std::sort(found_.begin(), found_.end(),
            [](const Intersection& a, const Intersection& b) { return a.first < b.first; });
  cells_.clear();
  return std::exchange(found_, {});
}

std::optional<Intersection> CurveMeetings::newton(const Range& r1, const Range& r2, double a, double b) const {
  double s = r1.begin + a * (r1.end - r1.begin);
  double t = r2.begin + b * (r2.end - r2.begin);
  for (int round = 0; round < newton_rounds; ++round) {
    const auto p = first_.at(s);
    const auto q = second_.at(t);
    const Eigen::Vector2d apart = q.position + shift_ - p.position;
    Eigen::Matrix2d tangents;
    tangents << p.first, -q.first;
    const double sine = tangents.determinant();
    if (apart.norm() <= agreement * (first_.length() + second_.length())) {
      if (std::abs(sine) < same_place) return std::nullopt;
      return Intersection{s, t, std::asin(std::min(1.0, std::abs(sine) / (p.first.norm() * q.first.norm())))};
    }
    const Eigen::Vector2d step = tangents.inverse() * apart;
    s += step[0];
    t += step[1];
    if (!r1.near(s) || !r2.near(t)) return std::nullopt;
  }
  return std::nullopt;
}

bool CurveMeetings::same(const Intersection& a, const Intersection& b) const {
  return std::abs(a.first - b.first) <= same_meeting * first_.length() &&
         std::abs(a.second - b.second) <= same_meeting * second_.length();
}

/// Coordinates are less than 2^32 sides of a cell: 1 / same_meeting.
std::uint64_t CurveMeetings::cell(double first, double second) const {
  const auto count = [](double coordinate, double length) {
    return static_cast<std::uint64_t>(std::max(0.0, coordinate / (same_meeting * length)) + 1);
  };
  return count(first, first_.length()) << 32U | count(second, second_.length());
}

bool CurveMeetings::known(const Intersection& found) const {
  if (cells_.empty())
    return std::any_of(found_.begin(), found_.end(), [&](const Intersection& other) { return same(other, found); });
  const std::uint64_t middle = cell(found.first, found.second);
  for (std::uint64_t row = 0; row < 3; ++row) {
    for (std::uint64_t column = 0; column < 3; ++column) {
      // Cells count from 1, so that there is one before each.
      const auto [begin, end] = cells_.equal_range(middle + ((row << 32U) + column) - ((1ULL << 32U) + 1));
      for (auto other = begin; other != end; ++other)
        if (same(found_[other->second], found)) return true;
    }
  }
  return false;
}

void CurveMeetings::keep(Intersection found) {
  if (!settle(first_, found.first) || !settle(second_, found.second) || known(found)) return;
  found_.push_back(found);
  if (found_.size() <= few_meetings) return;
  for (std::size_t k = cells_.size(); k < found_.size(); ++k)
    cells_.emplace(cell(found_[k].first, found_[k].second), static_cast<std::uint32_t>(k));
}

std::vector<Intersection> intersections(const StrandCurve& first, const StrandCurve& second,
                                        const Eigen::Vector2d& shift) {
  const PieceTree tree({{second, 1}}, {});
  const std::vector<Eigen::AlignedBox2d> boxes = piece_boxes(first);
  CurveMeetings meetings(first, second, shift);
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    near.clear();
    tree.for_each_near(boxes[i], shift, 0, [&near](std::int32_t, std::int32_t piece, const Eigen::AlignedBox2d&) {
      near.push_back(static_cast<std::size_t>(piece));
    });
    std::sort(near.begin(), near.end());
    for (const std::size_t j : near) meetings.add_pieces(i, j);
  }
  return meetings.take_sorted();
}

}  // namespace supple::weave
