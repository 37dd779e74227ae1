#include "supple/neural/error_features.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace supple::neural {
namespace {

/// The logarithm of a value that is first raised to a lower limit, below which differences are rounding.
double bounded_log(double value, double lower_limit) { return std::log(std::max(value, lower_limit)); }

/// Strains below this count as rest.
constexpr double min_strain = 1e-4;
/// Ratios of stiffnesses below this are not distinguished, because such states are hardly stable.
constexpr double min_stiffness_ratio = 1e-3;

Eigen::Vector3d eigenvalues_of(const Eigen::Matrix3d& tangent) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(tangent, Eigen::EigenvaluesOnly);
  return solver.eigenvalues();
}

/// Mohr's circle of a symmetric tensor with the components xx, yy and xy = shear.
struct MohrCircle {
  double mean;
  double half_difference;
  double shear;
  double radius;
};
MohrCircle mohr_circle(double xx, double yy, double shear) {
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

Eigen::VectorXd uniaxial_features(const DesignFeatures& design, const UniaxialFrame& frame, double axial_strain,
                                  const Eigen::Vector3d& strain, const UniaxialPoint& point) {
  const double s = design.rest_tangent.trace() / 3;
  const auto& rest = design.rest_eigenvalues;
  const auto now = eigenvalues_of(point.tangent);
  const auto slopes = path_slopes(frame, point.tangent);
  const double rest_slope = path_slopes(frame, design.rest_tangent).stiffness;
  const double size = std::abs(axial_strain);
  const double secant = size < min_strain ? rest_slope : std::abs(frame.directional(point.stress)) / size;
  const auto circle = mohr_circle(strain[0], strain[1], 0.5 * strain[2]);
  // The sign changes continuously over the strains that count as rest, so that error bars do not jump there.
  const double sign = std::clamp(axial_strain / min_strain, -1.0, 1.0);
  const std::array<double, 19> others{axial_strain,
                                      size,
                                      bounded_log(size, min_strain),
                                      circle.mean,
                                      circle.radius,
                                      bounded_log(point.energy_density / s, 1e-9),
                                      bounded_log(point.energy_density, 1e-9),
                                      bounded_log(s, 1e-3),
                                      bounded_log(rest_slope / s, 1e-4),
                                      bounded_log(slopes.stiffness / rest_slope, min_stiffness_ratio),
                                      bounded_log(secant / rest_slope, min_stiffness_ratio),
                                      bounded_log(now[0] / rest[0], min_stiffness_ratio),
                                      bounded_log(now[1] / rest[1], min_stiffness_ratio),
                                      bounded_log(now[2] / rest[2], min_stiffness_ratio),
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
  const auto e = mohr_circle(strain[0], strain[1], 0.5 * strain[2]);
  const auto sigma = mohr_circle(stress[0], stress[1], stress[2]);
  const double size = std::max(std::hypot(e.mean, e.radius), min_strain);
  const double stress_size = std::max(std::hypot(sigma.mean, sigma.radius), 1e-9);
  const double radius2 = e.radius * e.radius + 1e-12;
  // For a linear law, the work of the final stress on the strain is twice the energy, and this ratio is 1.
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
