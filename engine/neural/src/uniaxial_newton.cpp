#include "supple/neural/uniaxial_newton.h"

#include <algorithm>
#include <cmath>

namespace supple::neural {
namespace {

/// Largest change of E_dd in one increment.
constexpr double longest_increment = 0.1;
/// Largest change of the free strains in one step.
constexpr double longest_step = 0.2;
/// What suffices on the way to a state.
constexpr double tolerance_between = 1e-3;
/// Share of the decrease that the gradient promises which a step has to bring.
constexpr double sufficient_decrease = 1e-4;
/// Relative rounding of energies, which are squares of differences: within it the gradient decides.
constexpr double energy_rounding = 1e-10;

Eigen::Vector2d limited(const Eigen::Vector2d& step) {
  const double length = step.norm();
  return length > longest_step ? Eigen::Vector2d(step * (longest_step / length)) : step;
}

}  // namespace

bool UniaxialPoint::finite() const {
  return std::isfinite(energy_density) && stress.allFinite() && tangent.allFinite();
}

UniaxialNewton::UniaxialNewton(const UniaxialFrame& frame, const UniaxialOptions& options)
    : frame_(frame), options_(options) {}

void UniaxialNewton::start_from_rest(const UniaxialPoint& rest) {
  point_ = rest;
  given_ = 0;
  x_.setZero();
  phase_ = Phase::done;
}

void UniaxialNewton::go_to(double given) {
  target_ = given;
  iterations_ = 0;
  increments_left_ = std::max(1, static_cast<int>(std::ceil(std::abs(target_ - given_) / longest_increment - 1e-9)));
  predict();
}

void UniaxialNewton::go_straight_to(double given, const Eigen::Vector2d& step) {
  target_ = given;
  iterations_ = 0;
  increments_left_ = 0;
  iterations_here_ = 0;
  trial_given_ = given;
  trial_x_ = x_ + limited(step);
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
    trial_x_ = x_ + step_;
    return false;
  }
  given_ = trial_given_;
  x_ = trial_x_;
  point_ = trial;
  correct();
  return true;
}

/// Whether the energy falls, or near the end, where energies differ by rounding alone, the gradient.
bool UniaxialNewton::accepts(const UniaxialPoint& trial) const {
  if (!trial.finite()) return false;
  const double before = point_.energy_density;
  if (trial.energy_density <= before + sufficient_decrease * step_.dot(gradient_)) return true;
  return trial.energy_density <= before + energy_rounding * std::abs(before) &&
         (frame_.free.transpose() * trial.stress).norm() < 0.5 * gradient_.norm();
}

/// Goes on to the next increment along the path's tangent.
void UniaxialNewton::predict() {
  const double change = (target_ - given_) / increments_left_;
  --increments_left_;
  iterations_here_ = 0;
  const Eigen::Vector2d rate = -convex_solve(free_tangent(), frame_.free.transpose() * point_.tangent * frame_.along);
  trial_given_ = increments_left_ == 0 ? target_ : given_ + change;
  trial_x_ = x_ + limited(rate * change);
  phase_ = Phase::predicting;
}

/// The next Newton step, the next increment, or the end.
void UniaxialNewton::correct() {
  residual_ = uniaxial_residual(frame_, point_.stress, point_.tangent);
  const double tolerance = increments_left_ > 0 ? std::max(tolerance_between, options_.tolerance) : options_.tolerance;
  if (residual_ <= tolerance) {
    if (increments_left_ > 0) return predict();
    phase_ = Phase::done;
    return;
  }
  if (iterations_here_ == options_.max_iterations) {
    phase_ = Phase::failed;
    return;
  }
  ++iterations_;
  ++iterations_here_;
  gradient_ = frame_.free.transpose() * point_.stress;
  step_ = limited(-convex_solve(free_tangent(), gradient_));
  trial_given_ = given_;
  trial_x_ = x_ + step_;
  halvings_ = 0;
  phase_ = Phase::searching;
}

}  // namespace supple::neural
