#include <algorithm>

#include "curve.h"

namespace supple::outlines {

Point point_of(const Spline& spline, double t) {
  const auto degree = static_cast<std::size_t>(spline.degree);
  const std::size_t last = spline.control_points.size() - 1;
  // The span between knots k and k + 1 in which t lies.
  const auto first = spline.knots.begin() + static_cast<std::ptrdiff_t>(degree);
  const auto end = spline.knots.begin() + static_cast<std::ptrdiff_t>(last + 1);
  const auto after = std::upper_bound(first, end, t);
  const auto k = std::clamp(static_cast<std::size_t>(after - spline.knots.begin()) - 1, degree, last);
  std::vector<Eigen::Vector3d> d(degree + 1);
  for (std::size_t j = 0; j <= degree; ++j) {
    const std::size_t i = k - degree + j;
    const double weight = spline.weights.empty() ? 1 : spline.weights[i];
    d[j] << weight * spline.control_points[i], weight;
  }
  for (std::size_t r = 1; r <= degree; ++r) {
    for (std::size_t j = degree; j >= r; --j) {
      const double lower = spline.knots[k - degree + j], upper = spline.knots[k + 1 + j - r];
      const double fraction = upper > lower ? (t - lower) / (upper - lower) : 0;
      d[j] = (1 - fraction) * d[j - 1] + fraction * d[j];
    }
  }
  return d[degree].head<2>() / d[degree].z();
}

}  // namespace supple::outlines
