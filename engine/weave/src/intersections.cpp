#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "supple/weave/strand_curve.h"

namespace supple::weave {
namespace {

constexpr int newton_rounds = 20;
/// Two solutions are one, and a point lies on a piece's end, within this share of a curve's length.
constexpr double same_place = 1e-9;
/// A solution's two positions agree to this share of the lengths.
constexpr double agreement = 1e-11;
/// Steps of Newton's method may leave a piece by this share of it before it is another piece's business.
constexpr double overreach = 0.5;

/// The curve's boxes, a little larger than the pieces are.
std::vector<Eigen::AlignedBox2d> boxes(const StrandCurve& curve, const Eigen::Vector2d& shift) {
  const std::vector<double>& knots = curve.knots();
  std::vector<Eigen::AlignedBox2d> result;
  result.reserve(knots.size() - 1);
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    Eigen::AlignedBox2d box(curve.at(knots[i]).position);
    // A piece's last point by its own polynomial: the next piece's is the same, and beyond the last one a loop repeats.
    const double h = knots[i + 1] - knots[i];
    const auto begin = curve.at(knots[i]);
    box.extend(begin.position + h * (begin.first + h / 2 * (begin.second + h / 3 * begin.third)));
    // Pieces turn by little: they leave their chord by less than an eighth of their length times the turn.
    const Eigen::Vector2d margin = Eigen::Vector2d::Constant(h / 16 + same_place * curve.length());
    result.emplace_back(box.min() - margin + shift, box.max() + margin + shift);
  }
  return result;
}

/// The boxes that meet the smallest one around all the others: of curves that meet at a few places, a few.
std::vector<std::size_t> those_near(const std::vector<Eigen::AlignedBox2d>& boxes,
                                    const std::vector<Eigen::AlignedBox2d>& others) {
  Eigen::AlignedBox2d around;
  for (const Eigen::AlignedBox2d& other : others) around.extend(other);
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if (boxes[i].intersects(around)) near.push_back(i);
  return near;
}

struct Range {
  double begin, end;
  double slack() const { return overreach * (end - begin); }
  bool near(double s) const { return s >= begin - slack() && s <= end + slack(); }
};

class Search {
 public:
  Search(const StrandCurve& first, const StrandCurve& second, const Eigen::Vector2d& shift)
      : first_(first), second_(second), shift_(shift) {}

  std::vector<Intersection> all() {
    const auto boxes1 = boxes(first_, Eigen::Vector2d::Zero());
    const auto boxes2 = boxes(second_, shift_);
    const auto& k1 = first_.knots();
    const auto& k2 = second_.knots();
    const std::vector<std::size_t> near2 = those_near(boxes2, boxes1);
    for (const std::size_t i : those_near(boxes1, boxes2))
      for (const std::size_t j : near2)
        if (boxes1[i].intersects(boxes2[j])) in_pieces({k1[i], k1[i + 1]}, {k2[j], k2[j + 1]});
    std::sort(found_.begin(), found_.end(),
              [](const Intersection& a, const Intersection& b) { return a.first < b.first; });
    return std::move(found_);
  }

 private:
  void in_pieces(const Range& on_first, const Range& on_second) {
    // A line can cut one piece twice: once from each end.
    constexpr std::array<std::array<double, 2>, 5> starts{{{0.5, 0.5}, {0, 0}, {1, 1}, {0, 1}, {1, 0}}};
    for (const auto& [a, b] : starts)
      if (auto solution = newton(on_first, on_second, a, b)) keep(*solution);
  }

  std::optional<Intersection> newton(const Range& r1, const Range& r2, double a, double b) const {
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

  static bool settle(const StrandCurve& curve, double& s) {
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

  void keep(Intersection found) {
    if (!settle(first_, found.first) || !settle(second_, found.second)) return;
    const bool known = std::any_of(found_.begin(), found_.end(), [&](const Intersection& other) {
      return std::abs(other.first - found.first) <= same_place * 10 * first_.length() &&
             std::abs(other.second - found.second) <= same_place * 10 * second_.length();
    });
    if (!known) found_.push_back(found);
  }

  const StrandCurve& first_;
  const StrandCurve& second_;
  Eigen::Vector2d shift_;
  std::vector<Intersection> found_;
};

}  // namespace

std::vector<Intersection> intersections(const StrandCurve& first, const StrandCurve& second,
                                        const Eigen::Vector2d& shift) {
  return Search(first, second, shift).all();
}

}  // namespace supple::weave
