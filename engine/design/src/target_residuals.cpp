#include "target_residuals.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "free_parameters.h"

namespace supple::design {
namespace {

std::vector<Sample> all_samples(const std::vector<SampledTarget>& targets) {
  std::vector<Sample> samples;
  for (const auto& target : targets) {
    const auto more = samples_of(target.samples);
    samples.insert(samples.end(), more.begin(), more.end());
  }
  return samples;
}

std::span<const double> span_of(const Eigen::VectorXd& vector) {
  return {vector.data(), static_cast<std::size_t>(vector.size())};
}

}  // namespace

RobustDeviation robust_deviation(double deviation, double c) {
  const double q = std::abs(deviation / c);
  // For such a small q the quotient below would consist of rounding errors. The values at q = 0 are accurate enough.
  if (q < 1e-6) return {deviation, 1};
  const double root = std::sqrt(std::log1p(q * q));
  return {std::copysign(c * root, deviation), q / ((1 + q * q) * root)};
}

TargetResiduals::TargetResiduals(const neural::Evaluator& evaluator, const std::vector<SampledTarget>& targets,
                                 const std::vector<double>& target_weights, Eigen::VectorXd fixed_values,
                                 std::vector<Eigen::Index> free, double equilibrium_tolerance, Buildable buildable,
                                 double outlier_threshold)
    : evaluator_(evaluator),
      targets_(targets),
      target_weights_(target_weights),
      samples_(all_samples(targets)),
      fixed_values_(std::move(fixed_values)),
      free_(std::move(free)),
      buildable_(std::move(buildable)),
      equilibria_(evaluator, loadings_of(samples_), {.tolerance = equilibrium_tolerance}) {
  if (fixed_values_.size() != evaluator.shape().parameters + 1)
    throw std::invalid_argument("the held parameters are those of the family and the orientation");
  factors_.resize(static_cast<Eigen::Index>(samples_.size()));
  const double sum = std::accumulate(target_weights.begin(), target_weights.end(), 0.0);
  if (outlier_threshold > 0) outlier_thresholds_.resize(factors_.size());
  robust_slopes_.setOnes(factors_.size());
  Eigen::Index at = 0;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    first_samples_.push_back(static_cast<std::size_t>(at));
    const double target_factor = target_weights[t] / sum / (targets[t].scale * targets[t].scale);
    factors_.segment(at, targets[t].weights.size()) = (target_factor * targets[t].weights).cwiseSqrt();
    if (outlier_threshold > 0)
      outlier_thresholds_.segment(at, targets[t].weights.size()).setConstant(outlier_threshold * targets[t].scale);
    at += targets[t].weights.size();
  }
}

bool TargetResiduals::residuals(const Eigen::VectorXd& x, Eigen::VectorXd& r) {
  last_ = all_parameters(fixed_values_, free_, x);
  const Eigen::VectorXd parameters = family_part(last_);
  design_ = evaluator_.design(span_of(parameters), true);
  if (buildable_ && !buildable_(parameters)) return false;
  bool converged = false;
  if (saved_parameters_) {
    equilibria_.restore();
    converged = equilibria_.follow(*design_, parameters - family_part(*saved_parameters_),
                                   orientation_in(last_) - orientation_in(*saved_parameters_));
  } else {
    equilibria_.orient(orientation_in(last_));
    converged = equilibria_.from_rest(*design_);
  }
  const Eigen::VectorXd values = corrected_values();
  if (moduli_) chosen_ = moduli_->best(targets_, target_weights_, values);
  if (!converged) return false;
  const Eigen::VectorXd compared = scaled(targets_, values, chosen_.factor);
  const Eigen::Index n = factors_.size();
  r.resize(n + (limits_ ? LimitResiduals::count : 0));
  for (std::size_t t = 0; t < targets_.size(); ++t) {
    const auto first = static_cast<Eigen::Index>(first_samples_[t]);
    r.segment(first, targets_[t].y.size()) = targets_[t].deviations(compared.segment(first, targets_[t].y.size()));
  }
  for (Eigen::Index i = 0; i < outlier_thresholds_.size(); ++i) {
    const auto [value, slope] = robust_deviation(r[i], outlier_thresholds_[i]);
    r[i] = value;
    robust_slopes_[i] = slope;
  }
  r.head(n).array() *= factors_.array();
  if (limits_) r.tail<LimitResiduals::count>() = limit_residuals_ = limits_->at(parameters);
  return true;
}

void TargetResiduals::jacobian(Eigen::MatrixXd& jacobian) {
  equilibria_.save();
  saved_parameters_ = last_;
  Eigen::MatrixXd by_all;
  const bool by_orientation = !free_.empty() && free_.back() == last_.size() - 1;
  derivatives_.evaluate(evaluator_, *design_, samples_, equilibria_, by_all, by_orientation);
  derivative_evaluations_ += std::count_if(samples_.begin(), samples_.end(),
                                           [](const Sample& sample) { return sample.task != Task::stress_strain; });
  const Eigen::Index n = by_all.rows();
  Eigen::MatrixXd derivatives(n, static_cast<Eigen::Index>(free_.size()));
  for (std::size_t k = 0; k < free_.size(); ++k) derivatives.col(static_cast<Eigen::Index>(k)) = by_all.col(free_[k]);
  if (correction_) derivatives += correction_->slope;
  const Eigen::VectorXd values = corrected_values();
  if (moduli_) {
    // Product rule: the factor of the modulus depends on the values.
    const Eigen::RowVectorXd factor_slope = moduli_->slope(targets_, target_weights_, values, derivatives, chosen_);
    for (std::size_t t = 0; t < targets_.size(); ++t) {
      if (targets_[t].samples.task == Task::poisson) continue;
      const auto first = static_cast<Eigen::Index>(first_samples_[t]);
      const Eigen::Index count = targets_[t].y.size();
      derivatives.middleRows(first, count) *= chosen_.factor;
      derivatives.middleRows(first, count) += values.segment(first, count) * factor_slope;
    }
  }
  jacobian.resize(n + (limits_ ? LimitResiduals::count : 0), derivatives.cols());
  jacobian.topRows(n) = (factors_.array() * robust_slopes_.array()).matrix().asDiagonal() * derivatives;
  // The deviation is zero within the band.
  const Eigen::VectorXd compared = scaled(targets_, values, chosen_.factor);
  for (std::size_t t = 0; t < targets_.size(); ++t) {
    const auto first = static_cast<Eigen::Index>(first_samples_[t]);
    for (Eigen::Index i = 0; i < targets_[t].y.size(); ++i)
      if (std::abs(compared[first + i] - targets_[t].y[i]) < targets_[t].bands[i]) jacobian.row(first + i).setZero();
  }
  if (limits_)
    jacobian.bottomRows<LimitResiduals::count>() = limits_->derivatives(family_part(last_), free_, limit_residuals_);
}

Eigen::VectorXd TargetResiduals::model_values(std::size_t target) const {
  Eigen::VectorXd result(targets_[target].y.size());
  for (Eigen::Index i = 0; i < result.size(); ++i) {
    const std::size_t s = first_samples_[target] + static_cast<std::size_t>(i);
    const Equilibrium& state = equilibria_[s];
    result[i] =
        state.converged ? value_of(samples_[s], equilibria_.frame(s), state) : std::numeric_limits<double>::quiet_NaN();
  }
  return result;
}

Eigen::VectorXd TargetResiduals::values(std::size_t target) const {
  return factor_for(targets_[target].samples.task, chosen_.factor) * model_values(target);
}

Eigen::VectorXd TargetResiduals::corrected_values() const {
  Eigen::VectorXd result(factors_.size());
  for (std::size_t t = 0; t < targets_.size(); ++t)
    result.segment(static_cast<Eigen::Index>(first_samples_[t]), targets_[t].y.size()) = model_values(t);
  if (!correction_) return result;
  Eigen::VectorXd displacement(static_cast<Eigen::Index>(free_.size()));
  for (std::size_t k = 0; k < free_.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    displacement[column] = last_[free_[k]] - correction_->at[column];
  }
  return result + correction_->offset + correction_->slope * displacement;
}

ProfileTrust TargetResiduals::trust(const neural::Model& model, std::size_t target, neural::Origin origin) const {
  const Eigen::VectorXd parameters = family_part(last_);
  const neural::ErrorBars bars(model, evaluator_, *design_, span_of(parameters), true, origin);
  auto trust = profile_trust(model, bars, samples_, equilibria_, first_samples_[target], model_values(target));
  trust.error_bar *= factor_for(targets_[target].samples.task, chosen_.factor);
  return trust;
}

double TargetResiduals::largest_residual() const {
  double max_residual = 0;
  for (std::size_t i = 0; i < equilibria_.size(); ++i)
    if (equilibria_[i].converged) max_residual = std::max(max_residual, equilibria_[i].residual);
  return max_residual;
}

}  // namespace supple::design
