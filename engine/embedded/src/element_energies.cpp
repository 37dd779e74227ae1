#include "element_energies.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "x_minus_log1p.h"

namespace supple::embedded {
namespace {

/// 16 times the squared area of a triangle with these squared lengths (Heron's formula, a quadratic form).
double sixteen_squared_areas(const Eigen::Vector3d& squares) {
  const double sum = squares.sum();
  return sum * sum - 2 * squares.squaredNorm();
}
/// The gradient of that form.
Eigen::Vector3d slope_of_squared_areas(const Eigen::Vector3d& squares) {
  return Eigen::Vector3d::Constant(2 * squares.sum()) - 4 * squares;
}

}  // namespace

SpringElement spring_element(const Spring& spring, const LengthDerivatives& length) {
  SpringElement element({spring.from, spring.to});
  const double excess = length.length - spring.rest_length;
  element.value = spring.weight * excess * excess;
  element.gradient = 2 * spring.weight * excess * length.gradient;
  element.hessian = 2 * spring.weight * (length.gradient * length.gradient.transpose() + excess * length.hessian);
  return element;
}

SpringElement spring_element_at_zero(const Spring& spring, double turn, std::size_t number) {
  SpringElement element({spring.from, spring.to});
  element.value = spring.weight * spring.rest_length * spring.rest_length;
  const Eigen::Matrix2d rotation = Eigen::Rotation2Dd(turn).toRotationMatrix();
  element.hessian << Eigen::Matrix2d::Identity(), -rotation, -rotation.transpose(), Eigen::Matrix2d::Identity();
  element.hessian *= 2 * spring.weight;
  if (spring.rest_length > 0) {
    const double angle = static_cast<double>(number) * 2 * std::numbers::pi / std::numbers::phi;
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    element.gradient << direction, -rotation.transpose() * direction;
    element.gradient *= 2 * spring.weight * spring.rest_length;
  }
  return element;
}

TriangleEnergy::TriangleEnergy(const std::array<double, 3>& rest_lengths, const MembraneMaterial& material)
    : rest_lengths_(rest_lengths[0], rest_lengths[1], rest_lengths[2]) {
  rest_ = sixteen_squared_areas(rest_lengths_.cwiseAbs2());
  const double volume = material.thickness * std::sqrt(rest_) / 4;
  mu_ = volume * material.youngs_modulus / (2 * (1 + material.poisson_ratio));
  lambda_ = mu_ * 2 * material.poisson_ratio / (1 - 2 * material.poisson_ratio);
}

// Q(s) is 16 times the squared area of a triangle with the squared lengths s, s0 are those at rest, and D = s - s0. The
// Cauchy-Green tensor C has tr C - 2 = Q'(s0) D / Q(s0) and det C - 1 = tr C - 2 + Q(D) / Q(s0), where Q(D) / Q(s0) =
// det(C - I). In this form energies and forces of small strains keep their digits, which tr C - 2 - log det C loses.
TriangleEnergy::Value TriangleEnergy::by_squares(const Eigen::Vector3d& lengths) const {
  Value value;
  const Eigen::Vector3d squares = lengths.cwiseAbs2();
  const Eigen::Vector3d change = (lengths - rest_lengths_).cwiseProduct(lengths + rest_lengths_);
  const Eigen::Vector3d by_rest = slope_of_squared_areas(rest_lengths_.cwiseAbs2()) / rest_;
  const double quadratic = sixteen_squared_areas(change) / rest_;
  const double growth = by_rest.dot(change) + quadratic;  // det C - 1
  if (!(sixteen_squared_areas(squares) > 0) || !(growth > -1)) {
    value.energy = std::numeric_limits<double>::infinity();
    return value;
  }
  const double log_j = 0.5 * std::log1p(growth);
  value.energy = 0.5 * mu_ * (x_minus_log1p(growth) - quadratic) + 0.5 * lambda_ * log_j * log_j;
  // J^2 = det C = Q(s) / Q(s0): by the squared lengths, log J has the gradient q / 2, and log Q the gradient q.
  const double area = rest_ * (1 + growth);
  const Eigen::Vector3d q = slope_of_squared_areas(squares) / area;
  const Eigen::Vector3d beside = (growth * by_rest - slope_of_squared_areas(change) / rest_) / (1 + growth);
  const double by_log = lambda_ * log_j - mu_;
  value.first = 0.5 * mu_ * beside + 0.5 * lambda_ * log_j * q;
  Eigen::Matrix3d bend = Eigen::Matrix3d::Constant(2 / area);
  bend.diagonal().array() -= 4 / area;
  value.second = 0.25 * lambda_ * q * q.transpose() + 0.5 * by_log * (bend - q * q.transpose());
  return value;
}

TriangleEnergy::Value TriangleEnergy::at(const Eigen::Vector3d& lengths) const {
  Value value = by_squares(lengths);
  if (!std::isfinite(value.energy)) return value;
  const Eigen::Vector3d first = value.first;
  value.first = 2 * lengths.cwiseProduct(first);
  value.second = 4 * (lengths.asDiagonal() * value.second * lengths.asDiagonal()).eval();
  value.second.diagonal() += 2 * first;
  return value;
}

Eigen::Vector2d TriangleEnergy::stretches(const Eigen::Vector3d& lengths) const {
  const Eigen::Vector3d squares = lengths.cwiseAbs2();
  const double area = sixteen_squared_areas(squares);
  if (!(area > 0)) return Eigen::Vector2d::Zero();
  const double trace = slope_of_squared_areas(rest_lengths_.cwiseAbs2()).dot(squares) / rest_;
  const double determinant = area / rest_;
  const double root = std::sqrt(std::max(0.0, trace * trace - 4 * determinant));
  const double greater = 0.5 * (trace + root);
  return {std::sqrt(greater), std::sqrt(determinant / greater)};
}

}  // namespace supple::embedded
