#pragma once

#include <cmath>

namespace supple::embedded {

/// x - log(1 + x) for x > -1, accurate to rounding also for small x, where the difference would cancel.
inline double x_minus_log1p(double x) {
  if (std::abs(x) > 0.25) return x - std::log1p(x);
  // log(1 + x) = 2 artanh(r), and x - 2 r = r x.
  const double r = x / (2 + x);
  const double square = r * r;
  double sum = 0;
  for (int k = 17; k >= 3; k -= 2) sum = 1.0 / k + square * sum;
  return r * x - 2 * r * square * sum;
}

}  // namespace supple::embedded
