#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace supple::numerics {

enum class Interpolation {
  cubic,     ///< twice continuously differentiable spline; second derivatives vanish at the ends
  monotone,  ///< once continuously differentiable; stays between two neighbouring values [Fritsch1984]
  linear,
};
std::string_view to_string(Interpolation interpolation);

/// A curve y(x) through points. Without a period it continues linearly beyond its ends.
class Interpolant {
 public:
  /// Takes n >= 1 points with x strictly increasing and finite. With a period > 0, the last x is less than a period
  /// beyond the first one. Anything else is an error of the caller and asserts. O(n).
  Interpolant(std::span<const double> x, std::span<const double> y, Interpolation interpolation,
              std::optional<double> period = std::nullopt);

  /// The value at x. O(log n).
  double operator()(double x) const;

 private:
  std::vector<double> x_;
  std::vector<double> y_;
  std::vector<double> slopes_;  ///< dy/dx at the points
  std::optional<double> period_;
  bool linear_;
};

}  // namespace supple::numerics
