#include "supple/design/material_bound.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "rest_misfit.h"
#include "supple/base/random.h"

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
/// Number of random starts, and how many of each kind are followed. With 400 random targets, of which three quarters
/// are rough (as much amplitude in the eighth harmonic as in the first), the linear fit and an isotropic start alone
/// lead to more than the least deviation that 324 starts find ten times, by up to 14 % of it; with these twenty it is
/// one, by 4 %.
constexpr int random_start_count = 100;
constexpr int followed_random_starts = 12;
constexpr int followed_orthotropic_starts = 8;
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

/// Random compliances of trace 1, the same in each call.
std::vector<Vector6> random_starts() {
  RandomStream random("starts of the nearest material", 1);
  std::vector<Vector6> starts;
  for (int k = 0; k < random_start_count; ++k) {
    Eigen::Matrix3d factor;
    for (int entry = 0; entry < 9; ++entry) factor(entry) = random.uniform(-1, 1);
    const Eigen::Matrix3d compliance = factor * factor.transpose();
    starts.push_back(start_at(compliance / compliance.trace()));
  }
  return starts;
}

/// An orthotropic compliance with S11 = 1 and S22 = `ratio` in axes that are turned by `angle` counterclockwise.
/// `coupling` is -S12 over the geometric mean of the two.
Eigen::Matrix3d orthotropic(double angle, double ratio, double coupling, double shear) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  Eigen::Matrix3d strains;  // the strains of a unit elongation along each axis, and of a unit shear
  strains << c * c, s * s, -c * s, s * s, c * c, c * s, 2 * c * s, -2 * c * s, c * c - s * s;
  Eigen::Matrix3d compliance = Eigen::Vector3d(1, ratio, shear).asDiagonal();
  compliance(0, 1) = compliance(1, 0) = -coupling * std::sqrt(ratio);
  return strains * compliance * strains.transpose();
}

/// Materials in all orientations, from nearly isotropic ones to such as hardly resist shear or a load along one axis.
std::vector<Vector6> orthotropic_starts() {
  constexpr int orientations = 12;
  std::vector<Vector6> starts;
  for (int k = 0; k < orientations; ++k)
    for (const double ratio : {1.0, 4.0, 40.0})
      for (const double coupling : {-0.8, 0.0, 0.8})
        for (const double shear : {0.2, 2.0, 20.0})
          starts.push_back(start_at(orthotropic(std::numbers::pi * k / orientations, ratio, coupling, shear)));
  return starts;
}

/// The `count` starts with the least misfits, the least first.
std::vector<Vector6> promising(const std::vector<Vector6>& starts, int count, const RestMisfit& misfit) {
  std::vector<std::pair<double, const Vector6*>> order;
  order.reserve(starts.size());
  for (const Vector6& x : starts) order.emplace_back(misfit.value(x), &x);
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Vector6> chosen;
  chosen.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) chosen.push_back(*order[static_cast<std::size_t>(k)].second);
  return chosen;
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
  Vector6 best = start_at(misfit.linear_fit());
  double least_misfit = minimize(misfit, best);
  const auto descend = [&](Vector6 x) {
    const double value = minimize(misfit, x);
    if (!(value < least_misfit)) return;
    least_misfit = value;
    best = x;
  };
  if (least_misfit > negligible_misfit) descend(start_at(isotropic(poisson_ratio)));
  if (least_misfit > negligible_misfit) {
    static const auto orthotropic_ones = orthotropic_starts();
    static const auto random_ones = random_starts();
    for (const Vector6& x : promising(orthotropic_ones, followed_orthotropic_starts, misfit)) descend(x);
    for (const Vector6& x : promising(random_ones, followed_random_starts, misfit)) descend(x);
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
