#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace supple::tiling::testing {

/// An affine function of the parameters, constant + sum over k of slopes[k] * p_k. Coordinates of a tiling's vertices,
/// translations and placements are such functions.
struct Affine {
  static constexpr std::size_t max_parameters = 4;

  double constant = 0;
  std::array<double, max_parameters> slopes{};

  // This constructor is implicit, so that table entries can mix numbers and parameters.
  constexpr Affine() = default;
  constexpr Affine(double value) : constant(value) {}

  static constexpr Affine parameter(std::size_t index) {
    Affine result;
    result.slopes[index] = 1;
    return result;
  }

  constexpr double operator()(std::span<const double> parameters) const {
    double value = constant;
    for (std::size_t k = 0; k < parameters.size(); ++k) value += slopes[k] * parameters[k];
    return value;
  }
};

constexpr Affine operator*(double factor, const Affine& a) {
  Affine result(factor * a.constant);
  for (std::size_t k = 0; k < Affine::max_parameters; ++k) result.slopes[k] = factor * a.slopes[k];
  return result;
}
constexpr Affine operator+(const Affine& a, const Affine& b) {
  Affine result(a.constant + b.constant);
  for (std::size_t k = 0; k < Affine::max_parameters; ++k) result.slopes[k] = a.slopes[k] + b.slopes[k];
  return result;
}
constexpr Affine operator-(const Affine& a, const Affine& b) { return a + -1.0 * b; }
constexpr Affine operator-(const Affine& a) { return -1.0 * a; }

}  // namespace supple::tiling::testing
