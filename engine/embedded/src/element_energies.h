#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "network_state.h"
#include "supple/embedded/network.h"
#include "supple/numerics/term.h"

namespace supple::embedded {

/// Energy of one element and its derivatives by the tangent coordinates of its corners, two rows for each.
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

  /// Removes the motion of a point, one of the corners, along a unit vector: gradient and Hessian are projected onto
  /// the direction across it.
  void project_out(std::int32_t point, const Eigen::Vector2d& direction) {
    const int row = row_of(point);
    const Eigen::Matrix2d rest = Eigen::Matrix2d::Identity() - direction * direction.transpose();
    gradient.template segment<2>(row) = (rest * gradient.template segment<2>(row)).eval();
    hessian.template middleRows<2>(row) = (rest * hessian.template middleRows<2>(row)).eval();
    hessian.template middleCols<2>(row) = (hessian.template middleCols<2>(row) * rest).eval();
  }

  /// Sets the derivatives by a point's coordinates to zero. The derivatives by points at cone vertices are added
  /// separately.
  void zero_point(std::int32_t point) {
    const int row = row_of(point);
    gradient.template segment<2>(row).setZero();
    hessian.template middleRows<2>(row).setZero();
    hessian.template middleCols<2>(row).setZero();
  }

 private:
  int row_of(std::int32_t point) const { return static_cast<int>(std::ranges::find(rows, 2 * point) - rows.begin()); }
};
using SpringElement = PointsElement<2>;
using TriangleElement = PointsElement<3>;

/// weight (length - rest_length)^2 of a length with its derivatives [Thesis, eq. 3.13].
SpringElement spring_element(const Spring& spring, const LengthDerivatives& length);

/// The same for ends in one place, whose coordinates differ by a rotation of `turn` radians. The squared distance is
/// differentiable there. With a positive rest length the energy has a peak, whose slope is 2 weight rest_length in
/// every direction in which the ends separate: the direction of the gradient is chosen by the spring's number.
SpringElement spring_element_at_zero(const Spring& spring, double turn, std::size_t number);

/// The elastic energy of a flat triangle as a function of the lengths of its sides alone [Thesis, eq. 3.17 to 3.20].
/// C is the Cauchy-Green tensor: e^T C e is the squared length of the side that was the vector e at rest. The energy is
/// E = thickness * area * (mu / 2 (tr C - 2 - 2 log J) + lambda / 2 log(J)^2), J^2 = det C, with the area at rest.
class TriangleEnergy {
 public:
  /// Sides (0, 1), (1, 2), (2, 0).
  TriangleEnergy(const std::array<double, 3>& rest_lengths, const MembraneMaterial& material);

  /// The energy and its derivatives by the three lengths. The energy is infinite where no triangle has such sides.
  struct Value {
    double energy = 0;
    Eigen::Vector3d first = Eigen::Vector3d::Zero();
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  };
  Value at(const Eigen::Vector3d& lengths) const;
  /// The same with derivatives by the squared lengths.
  Value by_squares(const Eigen::Vector3d& lengths) const;

  /// Principal stretches, the greater first; zero where no triangle has such sides.
  Eigen::Vector2d stretches(const Eigen::Vector3d& lengths) const;

 private:
  Eigen::Vector3d rest_lengths_;
  double rest_ = 0;    ///< 16 times the squared area at rest
  double mu_ = 0;      ///< Lame's constant times thickness and area
  double lambda_ = 0;  ///< Lame's other constant times thickness and area
};

}  // namespace supple::embedded
