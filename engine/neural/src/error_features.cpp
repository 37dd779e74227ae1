#include "supple/neural/error_features.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace supple::neural {
namespace {

/// Logarithms end where they would tell rounding apart.
double bounded_log(double value, double least) { return std::log(std::max(value, least)); }

/// Strains below are rest.
constexpr double least_strain = 1e-4;
/// Ratios of stiffnesses below are those of a state that is no longer stable.
constexpr double least_ratio = 1e-3;

Eigen::Vector3d eigenvalues_of(const Eigen::Matrix3d& tangent) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(tangent, Eigen::EigenvaluesOnly);
  return solver.eigenvalues();
}

/// Mean and radius of Mohr's circle of (xx, yy) and half of `xy_twice`.
struct Circle {
  double mean;
  double half_difference;
  double shear;
  double radius;
};
Circle circle_of(double xx, double yy, double shear) {
  const double half = 0.5 * (xx - yy);
  return {0.5 * (xx + yy), half, shear, std::hypot(half, shear)};
}

Eigen::VectorXd joined(const Eigen::VectorXd& mapped, std::span<const double> others) {
  Eigen::VectorXd features(mapped.size() + static_cast<Eigen::Index>(others.size()));
  features << mapped, Eigen::Map<const Eigen::VectorXd>(others.data(), static_cast<Eigen::Index>(others.size()));
  return features;
}

}  // namespace

PathSlopes path_slopes(const UniaxialFrame& frame, const Eigen::Matrix3d& tangent) {
  const Eigen::Matrix2d h = frame.free.transpose() * tangent * frame.free;
  const Eigen::Vector2d rates = -convex_solve(h, frame.free.transpose() * tangent * frame.along);
  return {frame.along.dot(tangent * frame.strain(1, rates)), -rates[0]};
}

DesignFeatures design_features(const Network& network, std::span<const double> parameters, double rest_stiffness,
                               const Eigen::Matrix3d& rest_tangent) {
  return {mapped(network, parameters), rest_stiffness, rest_tangent, eigenvalues_of(rest_tangent)};
}

Eigen::VectorXd uniaxial_features(const DesignFeatures& design, const UniaxialFrame& frame, double given,
                                  const Eigen::Vector3d& strain, const UniaxialPoint& point) {
  const double s = design.rest_tangent.trace() / 3;
  const auto& rest = design.rest_stiffest;
  const auto now = eigenvalues_of(point.tangent);
  const auto slopes = path_slopes(frame, point.tangent);
  const double rest_slope = path_slopes(frame, design.rest_tangent).stiffness;
  const double size = std::abs(given);
  const double secant = size < least_strain ? rest_slope : std::abs(frame.directional(point.stress)) / size;
  const auto circle = circle_of(strain[0], strain[1], 0.5 * strain[2]);
  // The sign turns over the strains that count as rest, so that bars do not jump there.
  const double sign = std::clamp(given / least_strain, -1.0, 1.0);
  const std::array<double, 19> others{given,
                                      size,
                                      bounded_log(size, least_strain),
                                      circle.mean,
                                      circle.radius,
                                      bounded_log(point.energy_density / s, 1e-9),
                                      bounded_log(point.energy_density, 1e-9),
                                      bounded_log(s, 1e-3),
                                      bounded_log(rest_slope / s, 1e-4),
                                      bounded_log(slopes.stiffness / rest_slope, least_ratio),
                                      bounded_log(secant / rest_slope, least_ratio),
                                      bounded_log(now[0] / rest[0], least_ratio),
                                      bounded_log(now[1] / rest[1], least_ratio),
                                      bounded_log(now[2] / rest[2], least_ratio),
                                      bounded_log(rest[0] / rest[2], 1e-5),
                                      bounded_log(rest[1] / rest[2], 1e-5),
                                      bounded_log(now[0] / now[2], 1e-5),
                                      std::clamp(slopes.poisson, -3.0, 3.0),
                                      sign};
  return joined(design.mapped, others);
}

Eigen::VectorXd strain_features(const DesignFeatures& design, const Eigen::Vector3d& strain, double energy_density,
                                const Eigen::Vector3d& stress) {
  const double s = design.rest_stiffness;
  const auto e = circle_of(strain[0], strain[1], 0.5 * strain[2]);
  const auto sigma = circle_of(stress[0], stress[1], stress[2]);
  const double size = std::max(std::hypot(e.mean, e.radius), least_strain);
  const double stress_size = std::max(std::hypot(sigma.mean, sigma.radius), 1e-9);
  const double radius2 = e.radius * e.radius + 1e-12;
  // Of a linear law the work of the final stress is twice the energy.
  const double work = strain.dot(stress) / std::max(2 * energy_density, 1e-12);
  const std::array<double, 16> others{e.mean,
                                      e.radius,
                                      std::log(size),
                                      e.half_difference,
                                      e.shear,
                                      (e.half_difference * e.half_difference - e.shear * e.shear) / radius2,
                                      2 * e.half_difference * e.shear / radius2,
                                      bounded_log(energy_density, 1e-9),
                                      bounded_log(energy_density / s, 1e-9),
                                      bounded_log(s, 1e-3),
                                      bounded_log(stress_size, 1e-6),
                                      bounded_log(energy_density / (s * size * size), 1e-5),
                                      std::clamp(work, -3.0, 5.0),
                                      bounded_log(stress_size / (s * size), 1e-5),
                                      sigma.mean / stress_size,
                                      e.mean / size};
  return joined(design.mapped, others);
}

}  // namespace supple::neural
