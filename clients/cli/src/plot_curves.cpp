#include "plot_curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace supple::cli {
namespace {

using std::numbers::pi;

bool is_finite(Point point) { return std::isfinite(point.x) && std::isfinite(point.y); }

/// The segment from a sample of a curve to the next one.
struct Chord {
  double length = 0;  ///< difference of the parameter
  Point slope;        ///< difference of the positions over `length`
};

Chord chord_after(const Curve& curve, std::size_t i) {
  const std::size_t n = curve.points.size();
  const std::size_t next = (i + 1) % n;
  // The interval that closes the curve is assumed to be as long as the first one.
  const double length =
      next == 0 ? curve.parameter[1] - curve.parameter[0] : curve.parameter[next] - curve.parameter[i];
  const Point from = curve.points[i];
  const Point to = curve.points[next];
  return {length, {(to.x - from.x) / length, (to.y - from.y) / length}};
}

/// The slope of a smooth curve between two chords: their harmonic mean, or 0 at an extremum, so that the curve does not
/// overshoot the samples.
double slope_between(double before, double after) {
  return before * after > 0 ? 2 * before * after / (before + after) : 0;
}

/// The derivative of a smooth curve at a sample, by the parameter. On a closed curve it is the mean of the chords'
/// slopes.
Point tangent_at(const Curve& curve, std::size_t i) {
  const std::size_t n = curve.points.size();
  const bool has_before = (i > 0 || curve.closed) && is_finite(curve.points[(i + n - 1) % n]);
  const bool has_after = (i + 1 < n || curve.closed) && is_finite(curve.points[(i + 1) % n]);
  if (!has_before && !has_after) return {};
  const Point before = chord_after(curve, has_before ? (i + n - 1) % n : i).slope;
  const Point after = has_after ? chord_after(curve, i).slope : before;
  if (curve.closed) return {(before.x + after.x) / 2, (before.y + after.y) / 2};
  return {slope_between(before.x, after.x), slope_between(before.y, after.y)};
}

/// The indices that sort x.
std::vector<std::size_t> order_of(const std::vector<double>& x) {
  std::vector<std::size_t> order(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return x[a] < x[b]; });
  return order;
}

}  // namespace

std::vector<Curve> curves_of(const Frame& frame, const std::vector<double>& x, const std::vector<double>& y) {
  const auto order = order_of(x);
  std::vector<Curve> curves(frame.polar && !frame.all_around ? 2 : 1);
  for (int half = 0; half < (frame.polar ? 2 : 1); ++half) {
    auto& curve = curves[std::min<std::size_t>(static_cast<std::size_t>(half), curves.size() - 1)];
    for (const auto i : order) {
      // A parameter that occurs twice is used once.
      if (!curve.parameter.empty() && !(x[i] + half * pi > curve.parameter.back())) continue;
      curve.parameter.push_back(x[i] + half * pi);
      curve.points.push_back(frame.place(x[i] + half * pi, y[i]));
    }
    curve.closed = frame.all_around;
  }
  return curves;
}

std::string path_of(const Curve& curve) {
  const std::size_t n = curve.points.size();
  std::string path;
  bool open = false;
  for (std::size_t i = 0; i < n + (curve.closed ? 1 : 0); ++i) {
    const Point to = curve.points[i % n];
    if (!is_finite(to)) {
      open = false;
      continue;
    }
    if (!open || curve.straight) {
      path += fmt::format("{}{:.2f} {:.2f}", open ? 'L' : 'M', to.x, to.y);
      open = true;
      continue;
    }
    const double third = chord_after(curve, i - 1).length / 3;
    const Point from = curve.points[i - 1];
    const Point a = tangent_at(curve, i - 1);
    const Point b = tangent_at(curve, i % n);
    path += fmt::format("C{:.2f} {:.2f} {:.2f} {:.2f} {:.2f} {:.2f}", from.x + a.x * third, from.y + a.y * third,
                        to.x - b.x * third, to.y - b.y * third, to.x, to.y);
  }
  return path;
}

std::string path_of(const Frame& frame, const std::vector<double>& x, const std::vector<double>& y) {
  std::string path;
  if (y.empty()) return path;
  for (const auto& curve : curves_of(frame, x, y)) path += path_of(curve);
  return path;
}

}  // namespace supple::cli
