#include "trust_region_descent.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <utility>

namespace supple::design {
namespace {

// Lengths are fractions of the bounds' widths (normalized parameters) in the maximum norm.

/// Initial radius of the trust region, from min_radius to max_radius. Reduce it if most first steps are rejected.
constexpr double initial_radius = 0.1;
/// Maximum radius of the trust region, up to 1 (the whole box). Reduce it if long steps are often rejected.
constexpr double max_radius = 0.5;
/// Radius after probes, from min_radius to max_radius. If the response changes fast, the slopes that probes measure
/// hold only close to the best design. Increase it if most steps after probes are accepted.
constexpr double radius_after_probes = 0.01;
/// Radius below which a descent takes no more steps, > 0. Reduce it if designs so close to each other still differ by
/// more than the noise of their simulations.
constexpr double min_radius = 2e-4;
/// Minimum ratio of the actual to the predicted reduction of the deviation, in (0, 1), at which the trust region may
/// grow. Below it the radius becomes half of the step. Increase it if an accepted step is often followed by a rejected
/// one.
constexpr double min_reduction_ratio = 0.5;
/// Number of consecutive rejected steps after which a descent probes, >= 0. Probes cost one simulation for each free
/// parameter. Increase it for families with many parameters.
constexpr int max_rejected_steps = 2;
/// Number of consecutive rejected steps after which a descent ends if it has already probed, >= 1. Increase it if the
/// trust region is still far above min_radius when descents end.
constexpr int max_rejected_steps_after_probes = 4;
/// Change of the profile that a probe aims at, as a multiple of the profile's deviation, > 0. Increase it if noise of
/// the simulations hides the changes.
constexpr double probe_change_ratio = 2;
/// Minimum length of a probe, > 0. Increase it if noise hides the changes.
constexpr double min_probe_length = 1e-3;
/// Maximum length of a probe, up to 1. Reduce it if the response is strongly nonlinear over this length.
constexpr double max_probe_length = 0.05;
/// Maximum fraction of the deviation, in (0, 1), that may remain after the steps that followed probes, and after the
/// rounds of an allotment. A descent that is slower ends. Increase it if other starts rarely lead further.
constexpr double max_remaining_fraction = 0.7;
/// Minimum number of rounds of an allotment: those that a descent takes before its progress is checked. An allotment is
/// half of max_rounds if that is more. Increase it if descents from far away end before they come close.
constexpr int min_allotment = 8;

bool is_within_bounds(const Eigen::VectorXd& x) { return x.minCoeff() >= 0 && x.maxCoeff() <= 1; }

}  // namespace

TrustRegionDescent::TrustRegionDescent(PolishRounds& rounds, SimulatedDesign from)
    : rounds_(rounds),
      model_(rounds.model()),
      best_(std::move(from)),
      slope_(Eigen::MatrixXd::Zero(best_.simulated.size(), model_.width().size())),
      radius_(initial_radius) {}

std::optional<PolishTermination> TrustRegionDescent::run() {
  begin_allotment();
  while (true) {
    if (const auto termination = rounds_.termination()) return termination;
    if (is_allotment_spent()) {
      if (best_.deviation > max_remaining_fraction * deviation_at_allotment_) return std::nullopt;
      begin_allotment();
    }
    const CorrectedModel::Step step = best_step();
    if (is_promising(step) && rejected_ < (probed_ ? max_rejected_steps_after_probes : max_rejected_steps)) {
      try_step(step);
      continue;
    }
    if (probed_ || best_.deviation > max_remaining_fraction * deviation_at_probes_) return std::nullopt;
    probed_ = true;
    if (const auto termination = probe(step.x - best_.x)) return termination;
  }
}

void TrustRegionDescent::begin_allotment() {
  allotment_begin_ = rounds_.count();
  deviation_at_allotment_ = best_.deviation;
}

/// A descent spends at most about half of all rounds before its progress is checked, so that other starts remain
/// possible.
bool TrustRegionDescent::is_allotment_spent() const {
  return rounds_.count() - allotment_begin_ > std::max(min_allotment, rounds_.options().max_rounds / 2);
}

CorrectedModel::Step TrustRegionDescent::best_step() const {
  return model_.trust_region_step(correction(), radius_, rounds_.cancellation());
}

bool TrustRegionDescent::is_promising(const CorrectedModel::Step& step) const {
  return radius_ >= min_radius && step.predicted < (1 - min_predicted_reduction) * best_.deviation;
}

void TrustRegionDescent::try_step(const CorrectedModel::Step& step) {
  const SimulatedDesign trial = rounds_.simulate(Proposal::step, step.x);
  const Eigen::VectorXd displacement = trial.x - best_.x;
  const bool improves = trial.deviation < best_.deviation;
  const double actual_reduction = best_.deviation - trial.deviation;
  if (std::isfinite(trial.deviation)) update_slope(trial);
  const double length = displacement.cwiseAbs().maxCoeff();
  const bool trusted = improves && actual_reduction >= min_reduction_ratio * (best_.deviation - step.predicted);
  radius_ = trusted ? std::min(max_radius, std::max(radius_, 2 * length)) : length / 2;
  rejected_ = improves ? 0 : rejected_ + 1;
  if (improves) {
    best_ = trial;
    probed_ = false;
  }
}

/// Broyden's update: afterwards the correction is exact at the best design and at `trial`.
void TrustRegionDescent::update_slope(const SimulatedDesign& trial) {
  const Eigen::VectorXd displacement = trial.x - best_.x;
  const Eigen::VectorXd secant_error = trial.correction() - best_.correction() - slope_ * displacement;
  slope_ += secant_error * displacement.transpose() / displacement.squaredNorm();
}

/// Measures the slope of the correction by finite differences along the right singular vectors of the corrected
/// network's Jacobian. The length of each step is chosen so that the profile changes by probe_change_ratio times its
/// deviation. Steps in stiff directions are then short enough to stay in the same valley, and those in soft directions
/// are long enough to exceed the simulation's noise.
std::optional<PolishTermination> TrustRegionDescent::probe(const Eigen::VectorXd& preferred_direction) {
  deviation_at_probes_ = best_.deviation;
  TargetResiduals residuals = model_.residuals(correction());
  Eigen::VectorXd r;
  Eigen::MatrixXd jacobian;
  if (!residuals.residuals(model_.free_parameters(best_.x), r)) return std::nullopt;
  residuals.jacobian(jacobian);
  jacobian *= model_.width().asDiagonal();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(jacobian, Eigen::ComputeFullV);
  SimulatedDesign nearest = best_;
  for (Eigen::Index k = 0; k < model_.width().size(); ++k) {
    if (const auto termination = rounds_.termination()) return termination;
    const double sensitivity = k < svd.singularValues().size() ? svd.singularValues()[k] : 0;
    const double length = std::clamp(probe_change_ratio * best_.deviation / std::max(sensitivity, 1e-300),
                                     min_probe_length, max_probe_length);
    Eigen::VectorXd step = svd.matrixV().col(k) * length;
    if (step.dot(preferred_direction) < 0) step = -step;
    if (!is_within_bounds(best_.x + step) && is_within_bounds(best_.x - step)) step = -step;
    const Eigen::VectorXd x = (best_.x + step).cwiseMax(0).cwiseMin(1);
    if ((x - best_.x).norm() < min_probe_length / 2) continue;
    const SimulatedDesign trial = rounds_.simulate(Proposal::probe, x);
    if (!std::isfinite(trial.deviation)) continue;
    // If the bounds have shortened the step, it is not along the singular vector alone. The update is still valid.
    update_slope(trial);
    if (trial.deviation < nearest.deviation) nearest = trial;
  }
  best_ = std::move(nearest);
  radius_ = radius_after_probes;
  rejected_ = 0;
  return std::nullopt;
}

}  // namespace supple::design
