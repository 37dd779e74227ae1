#include "supple/design/material_bound.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "rest_misfit.h"

namespace supple::design {
namespace {

constexpr int max_iterations = 60;
/// The search from a start ends once a step reduces the mean squared deviation by at most this fraction.
constexpr double min_relative_decrease = 1e-9;
/// Half of a mean squared deviation that counts as none.
constexpr double negligible_misfit = 1e-20;
/// Damping of the first step, and the limits of damping, relative to the mean diagonal entry of the Hessian.
constexpr double initial_damping = 1e-3;
constexpr double min_damping = 1e-10;
constexpr double max_damping = 1e8;
/// The smallest eigenvalue of a start over its largest. A start at the boundary of all compliances could not leave it.
constexpr double min_start_eigenvalue = 1e-3;
/// The smallest eigenvalue of an answer over its trace.
constexpr double min_eigenvalue = 1e-13;
/// Isotropic starts have at most this magnitude of Poisson's ratio; isotropic materials have less than 1.
constexpr double max_start_poisson_ratio = 0.9;

/// Newton's method with damping, from x to a local minimum. Returns the misfit there.
double minimize(const RestMisfit& misfit, Vector6& x) {
  double value = misfit.value(x);
  double damping = initial_damping;
  Vector6 gradient;
  Matrix6 hessian;
  for (int iteration = 0; iteration < max_iterations && value > negligible_misfit; ++iteration) {
    misfit.derivatives(x, gradient, hessian);
    const double size = hessian.diagonal().cwiseAbs().mean();
    double next_value = std::numeric_limits<double>::infinity();
    Vector6 next;
    while (damping <= max_damping) {
      const Eigen::LLT<Matrix6> factored(hessian + damping * size * Matrix6::Identity());
      if (factored.info() == Eigen::Success) {
        next = x - factored.solve(gradient);
        next_value = misfit.value(next);
        if (next_value < value) break;
      }
      damping *= 6;
    }
    if (!(next_value < value)) break;
    const double decrease = value - next_value;
    x = next;
    value = next_value;
    damping = std::max(min_damping, damping / 10);
    if (decrease <= min_relative_decrease * value) break;
  }
  return value;
}

/// L of a compliance in excess of the least one, whose eigenvalues are raised so that it is positive definite.
Vector6 start_at(const Eigen::Matrix3d& excess) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(excess);
  const double largest = solver.eigenvalues().cwiseAbs().maxCoeff();
  const double floor = min_start_eigenvalue * (largest > 0 ? largest : 1);
  const Eigen::Matrix3d raised =
      solver.eigenvectors() * solver.eigenvalues().cwiseMax(floor).asDiagonal() * solver.eigenvectors().transpose();
  return entries_of(Eigen::LLT<Eigen::Matrix3d>(raised).matrixL());
}

/// An isotropic compliance with S11 = 1.
Eigen::Matrix3d isotropic(double poisson_ratio) {
  Eigen::Matrix3d compliance;
  compliance << 1, -poisson_ratio, 0, -poisson_ratio, 1, 0, 0, 0, 2 * (1 + poisson_ratio);
  return compliance;
}

/// The targets of one search for a material, and their weights.
struct WeightedTarget {
  const SampledTarget& target;
  double weight = 1;
};

double mean_of(const WeightedTarget& weighted) { return weighted.target.weights.dot(weighted.target.y); }

/// The compliance of the material that is nearest to the targets.
Compliance nearest_compliance(const std::vector<WeightedTarget>& targets, const Compliance& min_compliance) {
  double unit = 0;           // of stiffness, MPa
  double poisson_ratio = 0;  // mean of the targets
  double sum = 0;
  for (const WeightedTarget& weighted : targets) {
    if (weighted.target.samples.task == Task::stiffness) unit = std::max(unit, weighted.target.scale);
    if (weighted.target.samples.task == Task::poisson) poisson_ratio = mean_of(weighted);
    sum += weighted.weight;
  }
  // Without a stiffness the solid may be as stiff as needed.
  const Compliance least = unit > 0 ? Compliance(unit * min_compliance) : Compliance::Zero();
  if (!(unit > 0)) unit = 1;
  RestMisfit misfit(least, unit);
  for (const WeightedTarget& weighted : targets) misfit.add(weighted.target, weighted.weight / sum);

  poisson_ratio = std::clamp(poisson_ratio, -max_start_poisson_ratio, max_start_poisson_ratio);
  std::array<Vector6, 2> starts{start_at(misfit.linear_fit()), start_at(isotropic(poisson_ratio))};
  Vector6 best = starts.front();
  double least_misfit = std::numeric_limits<double>::infinity();
  for (Vector6& x : starts) {
    const double value = minimize(misfit, x);
    if (!(value < least_misfit)) continue;
    least_misfit = value;
    best = x;
    if (value <= negligible_misfit) break;
  }
  const Eigen::Matrix3d factor = factor_of(best);
  const Compliance nearest = least + factor * factor.transpose();
  // Values stay finite in directions that have no weight, too.
  return (nearest + min_eigenvalue * nearest.trace() * Compliance::Identity()) / unit;
}

RestProfile profile_at(const SampledTarget& target, const Compliance& compliance) {
  RestProfile profile;
  profile.y = rest_profile(compliance, target.samples.task, target.samples.x);
  profile.deviation = target.relative_rms(profile.y).value_or(std::numeric_limits<double>::infinity());
  return profile;
}

}  // namespace

Compliance solid_compliance(double youngs_modulus, double poisson_ratio) {
  // Plane strain: the isotropic solid has the modulus E / (1 - nu^2) and the ratio nu / (1 - nu) in its plane.
  const double modulus = youngs_modulus / (1 - poisson_ratio * poisson_ratio);
  return isotropic(poisson_ratio / (1 - poisson_ratio)) / modulus;
}

Eigen::VectorXd rest_profile(const Compliance& compliance, Task task, const std::vector<double>& directions) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(directions.size()));
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const auto [stress, lateral] = load_vectors(directions[static_cast<std::size_t>(i)]);
    const Eigen::Vector3d strain = compliance * stress;
    values[i] = (task == Task::poisson ? -lateral.dot(strain) : 1) / stress.dot(strain);
  }
  return values;
}

bool is_bounded(const SampledTarget& target) {
  return target.samples.task != Task::stress_strain && std::abs(target.samples.strain) <= max_bound_strain;
}

MaterialBounds material_bounds(const std::vector<SampledTarget>& targets, const std::vector<double>& weights,
                               const Compliance& min_compliance) {
  MaterialBounds bounds;
  std::vector<WeightedTarget> bounded;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    bounds.targets.emplace_back();
    if (!is_bounded(targets[t])) continue;
    bounded.push_back({targets[t], weights[t]});
    bounds.targets[t].emplace().alone = profile_at(targets[t], nearest_compliance({{targets[t], 1}}, min_compliance));
  }
  if (bounded.size() < 2) return bounds;
  const Compliance nearest = nearest_compliance(bounded, min_compliance);
  double squares = 0;
  double sum = 0;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    if (!bounds.targets[t]) continue;
    const RestProfile& together = bounds.targets[t]->together.emplace(profile_at(targets[t], nearest));
    squares += weights[t] * together.deviation * together.deviation;
    sum += weights[t];
  }
  bounds.together = std::sqrt(squares / sum);
  return bounds;
}

}  // namespace supple::design
