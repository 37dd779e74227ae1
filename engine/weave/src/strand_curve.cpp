#include "supple/weave/strand_curve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "supple/weave/weave_error.h"

namespace supple::weave {
namespace {

/// Maximum turning angle of a piece of the refined curve, rad. The parameter's speed then varies within a piece by the
/// square of this angle over a few hundred.
constexpr double max_piece_turn = 0.06;
constexpr double max_pieces_between_points = 4096;
/// Maximum depth of the bisection of a piece that turns by more than twice `max_piece_turn`.
constexpr int max_piece_bisections = 12;
/// Iterations that replace parameter lengths by arc lengths. Each one gains at least three digits.
constexpr int arc_length_iterations = 4;
/// Neighbouring points closer than this, relative to the extent, are the same point.
constexpr double same_point = 1e-9;
/// Points within this distance of a line, relative to the extent, lie on it.
constexpr double on_line = 1e-12;
/// Pieces between two checks for a stop request: a millisecond's work.
constexpr std::size_t curve_pieces_between_checks = 1024;

/// Gauss-Legendre points and weights on [-1, 1].
constexpr std::array<std::array<double, 2>, 5> gauss{{{-0.9061798459386640, 0.2369268850561891},
                                                      {-0.5384693101056831, 0.4786286704993665},
                                                      {0, 0.5688888888888889},
                                                      {0.5384693101056831, 0.4786286704993665},
                                                      {0.9061798459386640, 0.2369268850561891}}};

using Vectors = std::vector<Eigen::Vector2d>;

/// Solves a tridiagonal system of diagonally dominant rows in place: x holds the right-hand side r before and the
/// solution after, with below[i] x[i-1] + diagonal[i] x[i] + above[i] x[i+1] = r[i]. Checks for a stop request before
/// each of its two sweeps, which take some 10 ns for each row.
template <typename Value>
void solve_tridiagonal(const std::vector<double>& below, std::vector<double> diagonal, const std::vector<double>& above,
                       std::vector<Value>& x, const CancellationToken& cancellation) {
  cancellation.throw_if_requested();
  for (std::size_t i = 1; i < x.size(); ++i) {
    const double factor = below[i] / diagonal[i - 1];
    diagonal[i] -= factor * above[i - 1];
    x[i] -= factor * x[i - 1];
  }
  cancellation.throw_if_requested();
  x.back() /= diagonal.back();
  for (std::size_t i = x.size() - 1; i-- > 0;) x[i] = (x[i] - above[i] * x[i + 1]) / diagonal[i];
}

/// Second derivatives of the periodic spline at its knots, from the lengths h of its n intervals and the slopes of the
/// chords.
Vectors periodic_second_derivatives(const std::vector<double>& h, const Vectors& slopes,
                                    const CancellationToken& cancellation) {
  const std::size_t n = h.size();
  Vectors m(n);
  const auto right = [&](std::size_t i) -> Eigen::Vector2d { return 6 * (slopes[i] - slopes[(i + n - 1) % n]); };
  if (n == 1) {
    m[0] = Eigen::Vector2d::Zero();
  } else if (n == 2) {
    // With two intervals, both neighbours of a knot are the same knot.
    const double d = 2 * (h[0] + h[1]);
    const double o = h[0] + h[1];
    m[0] = (d * right(0) - o * right(1)) / (d * d - o * o);
    m[1] = (d * right(1) - o * right(0)) / (d * d - o * o);
  } else {
    // The matrix is a tridiagonal one plus a matrix of rank one that has the corner entries [Sherman1950].
    std::vector<double> below(n);
    std::vector<double> diagonal(n);
    std::vector<double> above(n);
    for (std::size_t i = 0; i < n; ++i) {
      below[i] = h[(i + n - 1) % n];
      above[i] = h[i];
      diagonal[i] = 2 * (below[i] + above[i]);
      m[i] = right(i);
    }
    const double corner = below[0];
    const double gamma = -diagonal[0];
    diagonal[0] -= gamma;
    diagonal[n - 1] -= corner * corner / gamma;
    std::vector<double> u(n, 0.0);
    u[0] = gamma;
    u[n - 1] = corner;
    solve_tridiagonal(below, diagonal, above, m, cancellation);
    solve_tridiagonal(below, diagonal, above, u, cancellation);
    const double denominator = 1 + u[0] + corner / gamma * u[n - 1];
    const Eigen::Vector2d factor = (m[0] + corner / gamma * m[n - 1]) / denominator;
    for (std::size_t i = 0; i < n; ++i) m[i] -= u[i] * factor;
  }
  m.push_back(m.front());
  return m;
}

/// Second derivatives of the spline of an open curve with not-a-knot ends: its first two pieces are one polynomial, and
/// so are its last two.
Vectors open_second_derivatives(const std::vector<double>& h, const Vectors& slopes,
                                const CancellationToken& cancellation) {
  const std::size_t n = h.size();
  if (n == 1) return {Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
  if (n == 2) return Vectors(3, 2 * (slopes[1] - slopes[0]) / (h[0] + h[1]));
  std::vector<double> below(n - 1);
  std::vector<double> diagonal(n - 1);
  std::vector<double> above(n - 1);
  Vectors inner(n - 1);
  for (std::size_t i = 1; i < n; ++i) {
    below[i - 1] = h[i - 1];
    above[i - 1] = h[i];
    diagonal[i - 1] = 2 * (h[i - 1] + h[i]);
    inner[i - 1] = 6 * (slopes[i] - slopes[i - 1]);
  }
  diagonal.front() += h[0] * (h[0] + h[1]) / h[1];
  above.front() -= h[0] * h[0] / h[1];
  diagonal.back() += h[n - 1] * (h[n - 1] + h[n - 2]) / h[n - 2];
  below.back() -= h[n - 1] * h[n - 1] / h[n - 2];
  solve_tridiagonal(below, diagonal, above, inner, cancellation);
  Vectors m;
  m.reserve(n + 1);
  m.emplace_back(((h[0] + h[1]) * inner[0] - h[0] * inner[1]) / h[1]);
  m.insert(m.end(), inner.begin(), inner.end());
  m.emplace_back(((h[n - 1] + h[n - 2]) * inner[n - 2] - h[n - 1] * inner[n - 3]) / h[n - 2]);
  return m;
}

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a[0] * b[1] - a[1] * b[0]; }

[[noreturn]] void refuse(const std::string& where, const std::string& message) {
  throw WeaveError("weave.invalid_strand", where + " " + message, {{where, message}});
}

[[noreturn]] void refuse_pieces() {
  refuse("points",
         "turn so often that their curve has more than " + std::to_string(StrandCurve::max_pieces) + " pieces");
}

void check(const Vectors& points, Ends ends, const Eigen::Vector2d& translation) {
  const std::size_t min_points = ends == Ends::open ? 2 : ends == Ends::closed ? 3 : 1;
  if (points.size() < min_points)
    refuse("points", "must be at least " + std::to_string(min_points) + ", got " + std::to_string(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!points[i].allFinite()) refuse("points/" + std::to_string(i), "must be finite");
  if (!translation.allFinite() || (ends == Ends::periodic) != (translation.norm() > 0))
    refuse("translation", "must be finite, not zero for a periodic strand and zero for any other");
}

}  // namespace

std::string_view to_string(Ends ends) {
  switch (ends) {
    case Ends::open:
      return "open";
    case Ends::closed:
      return "closed";
    case Ends::periodic:
      break;
  }
  return "periodic";
}

StrandCurve::StrandCurve(const std::vector<Eigen::Vector2d>& points, Ends ends, const Eigen::Vector2d& translation,
                         const Execution& execution)
    : ends_(ends), translation_(translation) {
  check(points, ends, translation);
  Vectors values = points;
  if (ends != Ends::open) values.emplace_back(points.front() + translation);
  double extent = 0;
  for (const Eigen::Vector2d& p : values) extent = std::max(extent, (p - values.front()).norm());
  knots_ = {0};
  knots_.reserve(values.size());
  const Eigen::Vector2d along = values.back() - values.front();
  straight_ = along.norm() > 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double chord = (values[i] - values[i - 1]).norm();
    if (!(chord > same_point * extent))
      refuse("points/" + std::to_string(i % points.size()), "is the same as the point before it");
    knots_.push_back(knots_.back() + chord);
    const Eigen::Vector2d offset = values[i] - values.front();
    straight_ = straight_ && std::abs(cross(along, offset)) <= on_line * extent * extent &&
                (values[i] - values[i - 1]).dot(along) > 0;
  }
  if (straight_) {
    point_coordinates_ = knots_;
    knots_ = {0, along.norm()};
    values_ = {values.front(), values.back()};
    second_derivatives_.assign(2, Eigen::Vector2d::Zero());
  } else {
    fit(values, execution);
    const std::vector<std::size_t> given = refine(execution);
    for (int iteration = 0; iteration < arc_length_iterations; ++iteration) {
      reparametrize(execution);
      fit(values_, execution);
    }
    point_coordinates_.reserve(given.size());
    for (const std::size_t i : given) point_coordinates_.push_back(knots_[i]);
  }
  if (ends != Ends::open) point_coordinates_.pop_back();
}

void StrandCurve::fit(std::vector<Eigen::Vector2d> values, const Execution& execution) {
  const std::size_t n = values.size() - 1;
  std::vector<double> h(n);
  Vectors slopes(n);
  for (std::size_t i = 0; i < n; ++i) {
    h[i] = knots_[i + 1] - knots_[i];
    slopes[i] = (values[i + 1] - values[i]) / h[i];
  }
  values_ = std::move(values);
  const auto second_derivatives = ends_ == Ends::open ? open_second_derivatives : periodic_second_derivatives;
  second_derivatives_ = second_derivatives(h, slopes, execution.cancellation);
}

std::vector<std::size_t> StrandCurve::refine(const Execution& execution) {
  Vectors refined;
  std::size_t next_check = 0;
  std::vector<std::size_t> given;
  given.reserve(values_.size());
  for (std::size_t piece = 0; piece + 1 < values_.size(); ++piece) {
    given.push_back(refined.size());
    const double h = knots_[piece + 1] - knots_[piece];
    // Through evenly spaced points, the curvature of a piece is greatest near one of its ends or in its middle.
    double curvature = 0;
    for (const double fraction : {0.0, 0.5, 1.0}) {
      const Point p = point_in_piece(piece, fraction * h);
      curvature = std::max(curvature, std::abs(cross(p.first, p.second)) / std::pow(p.first.norm(), 3));
    }
    const double turn = curvature * piece_length(piece, 0, h);
    // At a cusp the curvature is unbounded: the number is clamped before it is converted to an integer.
    const auto count = static_cast<int>(std::clamp(std::ceil(turn / max_piece_turn), 1.0, max_pieces_between_points));
    if (refined.size() + static_cast<std::size_t>(count) > max_pieces) refuse_pieces();
    for (int k = 0; k < count; ++k) {
      if (refined.size() >= next_check) {
        execution.cancellation.throw_if_requested();
        next_check = refined.size() + curve_pieces_between_checks;
      }
      refined.emplace_back(point_in_piece(piece, h * k / count).position);
      if (k == 0) refined.back() = values_[piece];
      bisect(piece, h * k / count, h * (k + 1) / count, max_piece_bisections, refined);
      if (refined.size() > max_pieces) refuse_pieces();
    }
  }
  given.push_back(refined.size());
  refined.push_back(values_.back());
  // The lengths of chords are the first parameter lengths.
  knots_.assign(1, 0);
  knots_.reserve(refined.size());
  for (std::size_t i = 1; i < refined.size(); ++i)
    knots_.push_back(knots_.back() + (refined[i] - refined[i - 1]).norm());
  fit(refined, execution);
  return given;
}

/// Bisects a part of a piece until each part turns by little. With uneven spacing the curvature can be greatest
/// anywhere, so the turning angle is measured at the middle of each part.
void StrandCurve::bisect(std::size_t piece, double begin, double end, int max_bisections, Vectors& refined) const {
  if (max_bisections == 0) return;
  const double middle = 0.5 * (begin + end);
  const Point there = point_in_piece(piece, middle);
  const auto turned = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return std::abs(std::atan2(cross(a, b), a.dot(b)));
  };
  const double turn =
      turned(point_in_piece(piece, begin).first, there.first) + turned(there.first, point_in_piece(piece, end).first);
  if (turn <= 2 * max_piece_turn) return;
  bisect(piece, begin, middle, max_bisections - 1, refined);
  refined.push_back(there.position);
  bisect(piece, middle, end, max_bisections - 1, refined);
}

void StrandCurve::reparametrize(const Execution& execution) {
  std::vector<double> knots{0};
  knots.reserve(knots_.size());
  for (std::size_t piece = 0; piece + 1 < knots_.size(); ++piece) {
    if (piece % curve_pieces_between_checks == 0) execution.cancellation.throw_if_requested();
    knots.push_back(knots.back() + piece_length(piece, 0, knots_[piece + 1] - knots_[piece]));
  }
  knots_ = std::move(knots);
}

StrandCurve::Point StrandCurve::point_in_piece(std::size_t piece, double t) const {
  const double h = knots_[piece + 1] - knots_[piece];
  const Eigen::Vector2d& m0 = second_derivatives_[piece];
  const Eigen::Vector2d& m1 = second_derivatives_[piece + 1];
  const Eigen::Vector2d slope = (values_[piece + 1] - values_[piece]) / h - h / 6 * (2 * m0 + m1);
  Point point;
  point.third = (m1 - m0) / h;
  point.second = m0 + t * point.third;
  point.first = slope + t * (m0 + t / 2 * point.third);
  point.position = values_[piece] + t * (slope + t * (m0 / 2 + t / 6 * point.third));
  return point;
}

double StrandCurve::piece_length(std::size_t piece, double from, double to) const {
  double sum = 0;
  for (const auto& [x, weight] : gauss)
    sum += weight * point_in_piece(piece, 0.5 * (from + to) + 0.5 * (to - from) * x).first.norm();
  return 0.5 * (to - from) * sum;
}

StrandCurve StrandCurve::scaled(double factor) const {
  StrandCurve curve = *this;
  curve.translation_ *= factor;
  for (double& knot : curve.knots_) knot *= factor;
  for (Eigen::Vector2d& value : curve.values_) value *= factor;
  for (Eigen::Vector2d& second : curve.second_derivatives_) second /= factor;
  for (double& coordinate : curve.point_coordinates_) coordinate *= factor;
  return curve;
}

StrandCurve::Point StrandCurve::at(double s) const {
  const double total = length();
  if (ends_ == Ends::open && !(s >= 0 && s <= total)) {
    Point end = s < 0 ? point_in_piece(0, 0) : point_in_piece(values_.size() - 2, total - knots_[knots_.size() - 2]);
    end.position += (s < 0 ? s : s - total) * end.first;
    end.second.setZero();
    end.third.setZero();
    return end;
  }
  const double periods = ends_ == Ends::open ? 0 : std::floor(s / total);
  const double local = s - periods * total;
  const auto next = std::upper_bound(knots_.begin(), knots_.end(), local);
  const auto piece =
      std::min(static_cast<std::size_t>(std::max<std::ptrdiff_t>(next - knots_.begin() - 1, 0)), values_.size() - 2);
  Point point = point_in_piece(piece, local - knots_[piece]);
  point.position += periods * translation_;
  return point;
}

}  // namespace supple::weave
