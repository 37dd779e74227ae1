#include "supple/neural/calibration.h"

#include <algorithm>
#include <cmath>

namespace supple::neural {

std::string_view to_string(Quantity quantity) {
  switch (quantity) {
    case Quantity::stiffness:
      return "stiffness";
    case Quantity::poisson:
      return "poisson";
    case Quantity::stress_at_strain:
      return "stress_at_strain";
    default:
      return "stress";
  }
}

double max_trusted_error(Quantity quantity) { return quantity == Quantity::stress ? 0.05 : 0.1; }

Eigen::VectorXd quadratic_terms(const Eigen::VectorXd& z) {
  const auto n = z.size();
  Eigen::VectorXd terms(1 + n + n * (n + 1) / 2);
  terms[0] = 1;
  terms.segment(1, n) = z;
  Eigen::Index at = 1 + n;
  for (Eigen::Index i = 0; i < n; ++i) {
    terms.segment(at, n - i) = z[i] * z.tail(n - i);
    at += n - i;
  }
  return terms;
}

Eigen::VectorXd normalized(const ErrorScale& scale, const Eigen::VectorXd& features) {
  return (features.cwiseMax(scale.least).cwiseMin(scale.greatest) - scale.mean).cwiseQuotient(scale.deviation);
}

double BarOffsets::at(double rating) const {
  const auto above = std::upper_bound(knots.begin(), knots.end(), rating);
  if (above == knots.begin()) return offsets.front();
  if (above == knots.end()) return offsets.back();
  const auto i = static_cast<std::size_t>(above - knots.begin());
  const double fraction = (rating - knots[i - 1]) / (knots[i] - knots[i - 1]);
  return offsets[i - 1] + fraction * (offsets[i] - offsets[i - 1]);
}

double rating(const ErrorScale& scale, const Eigen::VectorXd& features) {
  return scale.coefficients.dot(quadratic_terms(normalized(scale, features)));
}

double bar_of(const Calibration& calibration, double logarithm) {
  if (!(logarithm < std::log(largest_error))) return largest_error;
  return std::max(0.0, std::exp(logarithm) - calibration.floor);
}

double expected_error(const Calibration& calibration, Quantity quantity, const Eigen::VectorXd& features,
                      Origin origin) {
  const auto& scale = calibration.of(quantity);
  const double rated = rating(scale, features);
  return bar_of(calibration, rated + scale.of(origin).at(rated));
}

}  // namespace supple::neural
