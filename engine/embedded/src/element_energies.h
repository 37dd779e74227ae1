#pragma once

#include <array>
#include <cstdint>

#include "network_state.h"
#include "supple/embedded/network.h"
#include "supple/numerics/term.h"

namespace supple::embedded {

/// An element's share of the energy by the tangent coordinates of its corners, two rows for each.
template <int corners>
struct PointsElement {
  static constexpr int size = 2 * corners;
  std::array<std::int32_t, size> rows{};
  double value = 0;
  Eigen::Matrix<double, size, 1> gradient = Eigen::Matrix<double, size, 1>::Zero();
  Eigen::Matrix<double, size, size> hessian = Eigen::Matrix<double, size, size>::Zero();

  PointsElement() = default;
  explicit PointsElement(const std::array<std::int32_t, corners>& points) {
    for (std::size_t k = 0; k < points.size(); ++k) {
      rows[2 * k] = 2 * points[k];
      rows[2 * k + 1] = 2 * points[k] + 1;
    }
  }

  void add_to(numerics::EnergySum& sum, int order) const {
    std::array<double, numerics::HessianEntries::entries_of(size)> lower;
    auto* entry = lower.data();
    for (int k = 0; k < size; ++k)
      for (int l = 0; l <= k; ++l) *entry++ = hessian(k, l);
    sum.add_element(rows, order, value, gradient.data(), lower.data());
  }

  /// Takes the motion of a corner along a unit vector away: a wall stands there.
  void hold(int corner, const Eigen::Vector2d& along) {
    const Eigen::Matrix2d rest = Eigen::Matrix2d::Identity() - along * along.transpose();
    gradient.template segment<2>(2 * corner) = (rest * gradient.template segment<2>(2 * corner)).eval();
    hessian.template middleRows<2>(2 * corner) = (rest * hessian.template middleRows<2>(2 * corner)).eval();
    hessian.template middleCols<2>(2 * corner) = (hessian.template middleCols<2>(2 * corner) * rest).eval();
  }

  /// Takes a corner's rows away: what happens at a tip is added by itself.
  void take_out(int corner) {
    gradient.template segment<2>(2 * corner).setZero();
    hessian.template middleRows<2>(2 * corner).setZero();
    hessian.template middleCols<2>(2 * corner).setZero();
  }
};
using SpringElement = PointsElement<2>;
using TriangleElement = PointsElement<3>;

/// weight (length - rest_length)^2 of a length that has derivatives (thesis eq. 3.13).
SpringElement spring_element(const Spring& spring, const LengthDerivatives& length);

/// The same for ends in one place, whose coordinates differ by the rotation of `turn` radians. The squared distance is
/// differentiable there. With a rest length the energy has a peak: its slope is 2 weight rest_length whichever way the
/// ends part, and a direction, another for each spring, is chosen by its number.
SpringElement spring_element_at_zero(const Spring& spring, double turn, std::size_t number);

/// The elastic energy of a flat triangle as a function of the lengths of its sides alone (thesis eq. 3.17 to 3.20): C
/// is the Cauchy-Green tensor for which e^T C e is the squared length of each side that was e at rest, and
/// E = thickness * area * (mu / 2 (tr C - 2 - 2 log J) + lambda / 2 log(J)^2), J^2 = det C, area at rest.
class TriangleEnergy {
 public:
  /// Sides (0, 1), (1, 2), (2, 0).
  TriangleEnergy(const std::array<double, 3>& rest_lengths, const MembraneMaterial& material);

  /// The energy and its derivatives by the three lengths. It is infinite where no triangle has such sides.
  struct Value {
    double energy = 0;
    Eigen::Vector3d first = Eigen::Vector3d::Zero();
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  };
  Value at(const Eigen::Vector3d& lengths) const;
  /// The same with derivatives by the squared lengths.
  Value by_squares(const Eigen::Vector3d& lengths) const;

  /// Principal stretches, the greater first; zero where the lengths are of no triangle.
  Eigen::Vector2d stretches(const Eigen::Vector3d& lengths) const;

 private:
  Eigen::Vector3d rest_lengths_;
  double rest_ = 0;  ///< 16 times the squared area at rest
  double mu_ = 0;    ///< times thickness and area
  double lambda_ = 0;
};

}  // namespace supple::embedded
