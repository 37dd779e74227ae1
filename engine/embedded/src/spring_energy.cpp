#include "spring_energy.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace supple::embedded {
namespace {

std::array<std::int32_t, 4> rows_of(const Spring& spring) {
  return {2 * spring.from, 2 * spring.from + 1, 2 * spring.to, 2 * spring.to + 1};
}

}  // namespace

void SpringElement::add_to(numerics::EnergySum& sum, int order) const {
  std::array<double, numerics::HessianEntries::entries_of(4)> lower;
  auto* entry = lower.data();
  for (int k = 0; k < 4; ++k)
    for (int l = 0; l <= k; ++l) *entry++ = hessian(k, l);
  sum.add_element(rows, order, value, gradient.data(), lower.data());
}

SpringElement spring_element(const Spring& spring, const SpringLengthDerivatives& length) {
  SpringElement element;
  element.rows = rows_of(spring);
  const double excess = length.length - spring.rest_length;
  element.value = spring.weight * excess * excess;
  element.gradient = 2 * spring.weight * excess * length.gradient;
  element.hessian = 2 * spring.weight * (length.gradient * length.gradient.transpose() + excess * length.hessian);
  return element;
}

SpringElement spring_element_at_zero(const Spring& spring, double turn, std::size_t number) {
  SpringElement element;
  element.rows = rows_of(spring);
  element.value = spring.weight * spring.rest_length * spring.rest_length;
  const Eigen::Matrix2d rotation = Eigen::Rotation2Dd(turn).toRotationMatrix();
  element.hessian << Eigen::Matrix2d::Identity(), -rotation, -rotation.transpose(), Eigen::Matrix2d::Identity();
  element.hessian *= 2 * spring.weight;
  if (spring.rest_length > 0) {
    const double angle = static_cast<double>(number) * 2 * std::numbers::pi / std::numbers::phi;
    const Eigen::Vector2d way(std::cos(angle), std::sin(angle));
    element.gradient << way, -rotation.transpose() * way;
    element.gradient *= 2 * spring.weight * spring.rest_length;
  }
  return element;
}

}  // namespace supple::embedded
