#include "supple/numerics/interpolant.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <utility>

namespace supple::numerics {
namespace {

/// A symmetric, diagonally dominant tridiagonal system. It is cyclic if its first and last unknown are coupled too.
struct Tridiagonal {
  std::vector<double> diagonal, off_diagonal;  ///< off_diagonal[i] couples i and i + 1
  double cyclic = 0;  ///< couples the last unknown and the first; 0 if the system is not cyclic

  /// Solves the system without its cyclic coupling. O(n).
  std::vector<double> solve_open(std::vector<double> right) const {
    const std::size_t n = diagonal.size();
    std::vector<double> pivot = diagonal;
    for (std::size_t i = 1; i < n; ++i) {
      const double factor = off_diagonal[i - 1] / pivot[i - 1];
      pivot[i] -= factor * off_diagonal[i - 1];
      right[i] -= factor * right[i - 1];
    }
    for (std::size_t i = n; i-- > 0;) {
      if (i + 1 < n) right[i] -= off_diagonal[i] * right[i + 1];
      right[i] /= pivot[i];
    }
    return right;
  }

  /// Solves the system. A cyclic one is the open system plus a matrix of rank one [Sherman1950]. O(n).
  std::vector<double> solve(std::vector<double> right) const {
    if (cyclic == 0) return solve_open(std::move(right));
    const std::size_t last = diagonal.size() - 1;
    Tridiagonal open = *this;
    // The coupling is added as cyclic e e^T, with e = (1, 0, ..., 0, 1). What this adds to the diagonal is subtracted
    // first.
    open.diagonal[0] -= cyclic;
    open.diagonal[last] -= cyclic;
    std::vector<double> ends(diagonal.size(), 0.0);
    ends[0] = ends[last] = 1;
    const std::vector<double> direct = open.solve_open(std::move(right)), response = open.solve_open(ends);
    const double factor = cyclic * (direct[0] + direct[last]) / (1 + cyclic * (response[0] + response[last]));
    std::vector<double> result(direct.size());
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = direct[i] - factor * response[i];
    return result;
  }
};

/// Slopes of the C2 cubic spline. Second derivatives agree at all inner points, and vanish at ends without a period.
std::vector<double> spline_slopes(const std::vector<double>& x, const std::vector<double>& y, bool periodic) {
  const std::size_t n = x.size() - (periodic ? 1 : 0);  // number of unknowns; the last point repeats the first
  if (n == 1) return std::vector<double>(x.size(), 0.0);
  Tridiagonal system{std::vector<double>(n, 0.0), std::vector<double>(n - 1, 0.0)};
  std::vector<double> right(n, 0.0);
  // An interval of length h with secant s and end slopes m_0, m_1 contributes its second derivatives at its ends:
  // (2/h)(3 s - 2 m_0 - m_1) at the left and (2/h)(m_0 + 2 m_1 - 3 s) at the right one.
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    const double h = x[i + 1] - x[i];
    const double secant = (y[i + 1] - y[i]) / h;
    const std::size_t next = (i + 1) % n;
    system.diagonal[i] += 2 / h;
    system.diagonal[next] += 2 / h;
    if (next > i) {
      system.off_diagonal[i] += 1 / h;
    } else if (n == 2) {
      system.off_diagonal[0] += 1 / h;
    } else {
      system.cyclic += 1 / h;
    }
    right[i] += 3 * secant / h;
    right[next] += 3 * secant / h;
  }
  std::vector<double> slopes = system.solve(std::move(right));
  if (periodic) slopes.push_back(slopes.front());
  return slopes;
}

/// A weighted harmonic mean of the secants on both sides, or 0 where they differ in sign [Fritsch1984].
double monotone_slope(double h0, double s0, double h1, double s1) {
  if (s0 * s1 <= 0) return 0;
  const double weight = (h0 + 2 * h1) / (3 * (h0 + h1));
  return s0 * s1 / (weight * s1 + (1 - weight) * s0);
}

std::vector<double> monotone_slopes(const std::vector<double>& x, const std::vector<double>& y, bool periodic) {
  const std::size_t n = x.size();
  std::vector<double> secants(n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) secants[i] = (y[i + 1] - y[i]) / (x[i + 1] - x[i]);
  std::vector<double> slopes(n);
  for (std::size_t i = 1; i + 1 < n; ++i)
    slopes[i] = monotone_slope(x[i] - x[i - 1], secants[i - 1], x[i + 1] - x[i], secants[i]);
  if (periodic) {
    slopes[0] = slopes[n - 1] = monotone_slope(x[n - 1] - x[n - 2], secants[n - 2], x[1] - x[0], secants[0]);
  } else {
    slopes[0] = secants.front();
    slopes[n - 1] = secants.back();
  }
  return slopes;
}

}  // namespace

std::string_view to_string(Interpolation interpolation) {
  switch (interpolation) {
    case Interpolation::monotone:
      return "monotone";
    case Interpolation::linear:
      return "linear";
    default:
      return "cubic";
  }
}

Interpolant::Interpolant(std::span<const double> x, std::span<const double> y, Interpolation interpolation,
                         std::optional<double> period)
    : x_(x.begin(), x.end()), y_(y.begin(), y.end()), period_(period), linear_(interpolation == Interpolation::linear) {
  assert(!x_.empty() && x_.size() == y_.size());
  assert(std::is_sorted(x_.begin(), x_.end(), std::less_equal<>()) && "x increases strictly");
  if (period_) {
    assert(x_.back() < x_.front() + *period_);
    x_.push_back(x_.front() + *period_);
    y_.push_back(y_.front());
  }
  if (x_.size() == 1) {
    slopes_ = {0};
  } else if (interpolation == Interpolation::cubic) {
    slopes_ = spline_slopes(x_, y_, period_.has_value());
  } else {
    slopes_ = monotone_slopes(x_, y_, period_.has_value());
  }
}

double Interpolant::operator()(double x) const {
  if (x_.size() == 1) return y_.front();
  if (period_) x -= *period_ * std::floor((x - x_.front()) / *period_);
  const auto above = std::upper_bound(x_.begin() + 1, x_.end() - 1, x);
  const auto i = static_cast<std::size_t>(above - x_.begin()) - 1;
  const double h = x_[i + 1] - x_[i];
  const double t = (x - x_[i]) / h;
  if (linear_) return y_[i] + t * (y_[i + 1] - y_[i]);
  if (t < 0) return y_[i] + slopes_[i] * (x - x_[i]);
  if (t > 1) return y_[i + 1] + slopes_[i + 1] * (x - x_[i + 1]);
  const double u = 1 - t;
  return u * u * ((1 + 2 * t) * y_[i] + t * h * slopes_[i]) +
         t * t * ((3 - 2 * t) * y_[i + 1] - u * h * slopes_[i + 1]);
}

}  // namespace supple::numerics
