#include "supple/neural/uniaxial_newton.h"

#include <algorithm>
#include <cmath>

namespace supple::neural {
namespace {

/// Largest change of E_dd in one increment.
constexpr double max_increment = 0.1;
/// Largest change of the free strains in one step.
constexpr double max_step = 0.2;
/// Tolerance of the states between the increments.
constexpr double intermediate_tolerance = 1e-3;
/// Armijo's constant: the least ratio of a step's decrease of the energy to the one that the gradient predicts.
constexpr double sufficient_decrease = 1e-4;
/// Relative rounding errors of energies. If energies differ by less, the gradient decides whether a step is accepted.
constexpr double energy_rounding = 1e-10;

/// The step, shortened to at most max_step.
Eigen::Vector2d limited(const Eigen::Vector2d& step) {
  const double length = step.norm();
  return length > max_step ? Eigen::Vector2d(step * (max_step / length)) : step;
}

}  // namespace

bool UniaxialPoint::finite() const {
  return std::isfinite(energy_density) && stress.allFinite() && tangent.allFinite();
}

UniaxialNewton::UniaxialNewton(const UniaxialFrame& frame, const UniaxialOptions& options)
    : frame_(frame), options_(options) {}

void UniaxialNewton::start_from_rest(const UniaxialPoint& rest) {
  point_ = rest;
  axial_strain_ = 0;
  free_strains_.setZero();
  phase_ = Phase::done;
}

void UniaxialNewton::go_to(double axial_strain) {
  target_axial_strain_ = axial_strain;
  iterations_ = 0;
  remaining_increments_ =
      std::max(1, static_cast<int>(std::ceil(std::abs(target_axial_strain_ - axial_strain_) / max_increment - 1e-9)));
  predict();
}

void UniaxialNewton::start_in_one_increment(double axial_strain, const Eigen::Vector2d& step) {
  target_axial_strain_ = axial_strain;
  iterations_ = 0;
  remaining_increments_ = 0;
  increment_iterations_ = 0;
  trial_axial_strain_ = axial_strain;
  trial_free_strains_ = free_strains_ + limited(step);
  phase_ = Phase::predicting;
}

bool UniaxialNewton::receive(const UniaxialPoint& trial) {
  if (phase_ == Phase::predicting && !trial.finite()) {
    phase_ = Phase::failed;
    return false;
  }
  if (phase_ == Phase::searching && !accepts(trial)) {
    if (++halvings_ > options_.max_halvings) phase_ = Phase::failed;
    step_ /= 2;
    trial_free_strains_ = free_strains_ + step_;
    return false;
  }
  axial_strain_ = trial_axial_strain_;
  free_strains_ = trial_free_strains_;
  point_ = trial;
  correct();
  return true;
}

bool UniaxialNewton::accepts(const UniaxialPoint& trial) const {
  if (!trial.finite()) return false;
  const double before = point_.energy_density;
  if (trial.energy_density <= before + sufficient_decrease * step_.dot(gradient_)) return true;
  return trial.energy_density <= before + energy_rounding * std::abs(before) &&
         (frame_.free.transpose() * trial.stress).norm() < 0.5 * gradient_.norm();
}

void UniaxialNewton::predict() {
  const double change = (target_axial_strain_ - axial_strain_) / remaining_increments_;
  --remaining_increments_;
  increment_iterations_ = 0;
  const Eigen::Vector2d rate = -convex_solve(free_tangent(), frame_.free.transpose() * point_.tangent * frame_.along);
  trial_axial_strain_ = remaining_increments_ == 0 ? target_axial_strain_ : axial_strain_ + change;
  trial_free_strains_ = free_strains_ + limited(rate * change);
  phase_ = Phase::predicting;
}

void UniaxialNewton::correct() {
  residual_ = uniaxial_residual(frame_, point_.stress, point_.tangent);
  const double tolerance =
      remaining_increments_ > 0 ? std::max(intermediate_tolerance, options_.tolerance) : options_.tolerance;
  if (residual_ <= tolerance) {
    if (remaining_increments_ > 0) return predict();
    phase_ = Phase::done;
    return;
  }
  if (increment_iterations_ == options_.max_iterations) {
    phase_ = Phase::failed;
    return;
  }
  ++iterations_;
  ++increment_iterations_;
  gradient_ = frame_.free.transpose() * point_.stress;
  step_ = limited(-convex_solve(free_tangent(), gradient_));
  trial_axial_strain_ = axial_strain_;
  trial_free_strains_ = free_strains_ + step_;
  halvings_ = 0;
  phase_ = Phase::searching;
}

}  // namespace supple::neural
