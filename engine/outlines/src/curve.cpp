#include "curve.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "supple/base/error.h"

namespace supple::outlines {
namespace {

/// Arcs of a smaller bulge are straight lines: they are at most half of this, times the chord, away from it.
constexpr double min_bulge = 1e-9;
/// Bisections of a span between two knots. The first ones are made always, so that no bend is overlooked.
constexpr int max_bisections = 16;
constexpr int min_bisections = 2;

[[noreturn]] void refuse_corners() {
  const std::string limit = std::to_string(Flattener::max_corners);
  throw Error("outline.too_large", "The drawing has more than " + limit + " corners at this tolerance.",
              {{"accuracy/tolerance", "gives more than " + limit + " corners; a coarser one gives fewer"}});
}

double distance_to_chord(const Point& p, const Point& a, const Point& b) {
  const Point along = b - a;
  const double squared = along.squaredNorm();
  const double t = squared > 0 ? std::clamp((p - a).dot(along) / squared, 0.0, 1.0) : 0.0;
  return (p - a - t * along).norm();
}

}  // namespace

Piece bulge(const Point& a, const Point& b, double bulge) {
  const Point chord = b - a;
  if (!(std::abs(bulge) > min_bulge) || chord.isZero(0)) return Line{b};
  const Point left(-chord.y(), chord.x());
  const Point centre = (a + b) / 2 + left * (1 - bulge * bulge) / (4 * bulge);
  const Point radius = a - centre;
  return Arc{centre, radius, Point(-radius.y(), radius.x()), 0, 4 * std::atan(bulge), b};
}

void transform(Curve& curve, const Map& map) {
  struct Move {
    const Map& map;
    void operator()(Line& line) const { line.to = map * line.to; }
    void operator()(Cubic& cubic) const {
      cubic.first = map * cubic.first;
      cubic.second = map * cubic.second;
      cubic.to = map * cubic.to;
    }
    void operator()(Arc& arc) const {
      arc.centre = map * arc.centre;
      arc.cosine = map.linear() * arc.cosine;
      arc.sine = map.linear() * arc.sine;
      arc.to = map * arc.to;
    }
    void operator()(Spline& spline) const {
      for (Point& p : spline.control_points) p = map * p;
    }
  };
  curve.begin = map * curve.begin;
  for (Piece& piece : curve.pieces) std::visit(Move{map}, piece);
}

Points Flattener::flatten(const Curve& curve) {
  points_.clear();
  add(curve.begin);
  for (const Piece& piece : curve.pieces) {
    std::visit([this](const auto& p) { append(p); }, piece);
  }
  if (curve.closed && points_.size() > 1 && points_.back() == points_.front()) points_.pop_back();
  return std::move(points_);
}

void Flattener::add(const Point& point) {
  // Repeated points count too: the limit bounds the time that curves of zero length take.
  if (++corners_ > max_corners) refuse_corners();
  if (!points_.empty() && points_.back() == point) return;
  points_.push_back(point);
}

std::size_t Flattener::part_count(double real_count) const {
  // NaN and numbers beyond the range of an integer cannot be converted.
  if (!(real_count < static_cast<double>(max_corners))) refuse_corners();
  return static_cast<std::size_t>(std::max(1.0, std::ceil(real_count)));
}

void Flattener::append(const Line& line) { add(line.to); }

void Flattener::append(const Cubic& cubic) {
  const Point start = points_.back();
  // A chord over a parameter step h is at most h^2 / 8 times the largest second derivative away from its curve.
  const double max_second_derivative =
      6 * std::max((start - 2 * cubic.first + cubic.second).norm(), (cubic.first - 2 * cubic.second + cubic.to).norm());
  const std::size_t n = part_count(std::sqrt(max_second_derivative / (8 * tolerance_)));
  chord_error_ = std::max(chord_error_, max_second_derivative / (8 * static_cast<double>(n * n)));
  for (std::size_t k = 1; k < n; ++k) {
    const double t = static_cast<double>(k) / static_cast<double>(n), s = 1 - t;
    add(s * s * s * start + 3 * s * s * t * cubic.first + 3 * s * t * t * cubic.second + t * t * t * cubic.to);
  }
  add(cubic.to);
}

void Flattener::append(const Arc& arc) {
  Eigen::Matrix2d axes;
  axes << arc.cosine, arc.sine;
  const double radius = Eigen::JacobiSVD<Eigen::Matrix2d>(axes).singularValues()[0];
  // The chord of an arc of angle h and radius r is r (1 - cos(h / 2)) away from it. For an ellipse, its longer semiaxis
  // as r gives a bound.
  const double max_angle =
      tolerance_ < radius ? 2 * std::acos(1 - std::min(1.0, tolerance_ / radius)) : std::numbers::pi / 2;
  const double total_angle = std::abs(arc.sweep);
  std::size_t n = part_count(std::max(total_angle / std::max(max_angle, 1e-12), total_angle / (std::numbers::pi / 2)));
  // A whole ellipse gets a multiple of 4 chords, so that the ends of its axes are corners.
  if (total_angle >= 2 * std::numbers::pi) n = (n + 3) / 4 * 4;
  const double angle = arc.sweep / static_cast<double>(n);
  chord_error_ = std::max(chord_error_, radius * (1 - std::cos(angle / 2)));
  for (std::size_t k = 1; k < n; ++k) {
    const double t = arc.from + angle * static_cast<double>(k);
    add(arc.centre + arc.cosine * std::cos(t) + arc.sine * std::sin(t));
  }
  add(arc.to);
}

void Flattener::append(const Spline& spline) {
  const auto degree = static_cast<std::size_t>(spline.degree);
  Point from = point_of(spline, spline.knots[degree]);
  add(from);
  for (std::size_t k = degree; k < spline.control_points.size(); ++k) {
    if (!(spline.knots[k] < spline.knots[k + 1])) continue;
    const Point to = point_of(spline, spline.knots[k + 1]);
    append_span(spline, spline.knots[k], spline.knots[k + 1], from, to, 0);
    from = to;
  }
}

void Flattener::append_span(const Spline& spline, double t0, double t1, const Point& a, const Point& b, int depth) {
  const double middle = (t0 + t1) / 2;
  const Point centre = point_of(spline, middle);
  double error = distance_to_chord(centre, a, b);
  for (const double t : {(t0 + middle) / 2, (middle + t1) / 2})
    error = std::max(error, distance_to_chord(point_of(spline, t), a, b));
  // Half the tolerance, since the distance is measured at three points only.
  if (depth >= max_bisections || (depth >= min_bisections && error <= tolerance_ / 2)) {
    chord_error_ = std::max(chord_error_, error);
    return add(b);
  }
  append_span(spline, t0, middle, a, centre, depth + 1);
  append_span(spline, middle, t1, centre, b, depth + 1);
}

}  // namespace supple::outlines
