#include "corrected_model.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace supple::design {
namespace {

constexpr double min_search_tolerance = 1e-8;
/// Length of the error bar of a sample for which the model has none, as a fraction of the target's scale.
constexpr double assumed_error_bar = 0.1;

}  // namespace

ProfileSamples oriented(ProfileSamples samples, const Eigen::VectorXd& parameters) {
  samples.orientation = orientation_in(parameters);
  return samples;
}

CorrectedModel::CorrectedModel(const DesignSpace& space, const DesignProblem& problem, double tolerance)
    : space_(space),
      bounds_(space, problem),
      lower_(bounds_.free_part(bounds_.lower)),
      width_(bounds_.free_part(bounds_.upper) - lower_),
      moduli_(problem.moduli, space.model.provenance.youngs_modulus),
      structure_limits_(problem.limits),
      limit_residuals_(space_, problem.limits),
      tolerance_(tolerance),
      search_tolerance_(std::max(tolerance, min_search_tolerance)) {
  for (const Target& target : problem.targets) {
    targets_.push_back(sample_target(target));
    weights_.push_back(target.weight);
  }
}

Eigen::Index CorrectedModel::samples() const {
  Eigen::Index n = 0;
  for (const SampledTarget& target : targets_) n += target.y.size();
  return n;
}

Eigen::VectorXd CorrectedModel::normalized(const Eigen::VectorXd& parameters) const {
  return (bounds_.free_part(parameters) - lower_).cwiseQuotient(width_);
}

Eigen::VectorXd CorrectedModel::free_parameters(const Eigen::VectorXd& x) const {
  return lower_ + x.cwiseProduct(width_);
}

Eigen::VectorXd CorrectedModel::parameters_at(const Eigen::VectorXd& x) const {
  return all_parameters(bounds_.fixed_values, bounds_.free, free_parameters(x));
}

Eigen::VectorXd CorrectedModel::scales() const {
  Eigen::VectorXd result(samples());
  Eigen::Index at = 0;
  for (const SampledTarget& target : targets_) {
    result.segment(at, target.y.size())
        .setConstant(target.scale / factor_for(target.samples.task, moduli_.limits().first));
    at += target.y.size();
  }
  return result;
}

std::vector<Eigen::VectorXd> CorrectedModel::split_by_target(const Eigen::VectorXd& values) const {
  std::vector<Eigen::VectorXd> parts;
  Eigen::Index at = 0;
  for (const SampledTarget& target : targets_) {
    const Eigen::Index n = target.y.size();
    parts.push_back(values.size() > 0 ? Eigen::VectorXd(values.segment(at, n))
                                      : Eigen::VectorXd::Constant(n, std::numeric_limits<double>::quiet_NaN()));
    at += n;
  }
  return parts;
}

ModulusChoice::Chosen CorrectedModel::modulus_for(const Eigen::VectorXd& values) const {
  return moduli_.best(targets_, weights_, values);
}

double CorrectedModel::deviation(const Eigen::VectorXd& model_values) const {
  const Eigen::VectorXd values = scaled(targets_, model_values, modulus_for(model_values).factor);
  double sum = 0, weights = 0;
  Eigen::Index at = 0;
  for (std::size_t t = 0; t < targets_.size(); ++t) {
    const Eigen::Index n = targets_[t].y.size();
    sum += weights_[t] * std::pow(targets_[t].relative_rms(values.segment(at, n)).value_or(infinite), 2);
    weights += weights_[t];
    at += n;
  }
  return std::isfinite(sum) ? std::sqrt(sum / weights) : infinite;
}

CorrectedModel::Values CorrectedModel::values_at(const Eigen::VectorXd& parameters,
                                                 double equilibrium_tolerance) const {
  Values result{Eigen::VectorXd(samples()), 0};
  Eigen::VectorXd bars(samples());
  Eigen::Index at = 0;
  const std::span<const double> span(parameters.data(), static_cast<std::size_t>(parameters.size() - 1));
  for (const SampledTarget& target : targets_) {
    const Eigen::Index n = target.y.size();
    const Profile profile = evaluate_profile(space_.model, space_.evaluator, span, oriented(target.samples, parameters),
                                             equilibrium_tolerance);
    result.values.segment(at, n) = profile.y;
    if (profile.error_bar.size() > 0)
      bars.segment(at, n) = profile.error_bar / target.scale;
    else
      bars.segment(at, n).setConstant(std::numeric_limits<double>::quiet_NaN());
    at += n;
  }
  bars = scaled(targets_, bars, modulus_for(result.values).factor);
  double sum = 0, weights = 0;
  at = 0;
  for (std::size_t t = 0; t < targets_.size(); ++t) {
    for (Eigen::Index k = 0; k < targets_[t].y.size(); ++k, ++at)
      sum += weights_[t] * targets_[t].weights[k] * std::pow(std::isfinite(bars[at]) ? bars[at] : assumed_error_bar, 2);
    weights += weights_[t];
  }
  result.bar = std::sqrt(sum / weights);
  return result;
}

std::optional<CorrectedModel::Values> CorrectedModel::feasible_values(const Eigen::VectorXd& x) const {
  const Eigen::VectorXd parameters = parameters_at(x);
  if (space_.buildable && !space_.buildable(family_part(parameters))) return std::nullopt;
  if (!excess_at(parameters).empty()) return std::nullopt;
  Values found = values_at(parameters, search_tolerance_);
  if (!found.values.allFinite()) return std::nullopt;
  return found;
}

TargetResiduals CorrectedModel::residuals(const Correction& correction) const {
  TargetResiduals residuals(space_.evaluator, targets_, weights_, bounds_.fixed_values, bounds_.free, search_tolerance_,
                            space_.buildable);
  residuals.choose_among(moduli_);
  residuals.add_limits(limit_residuals_);
  // The residuals are functions of the parameters themselves, and the correction is one of normalized parameters.
  residuals.correct(
      {correction.offset, correction.slope * width_.cwiseInverse().asDiagonal(), free_parameters(correction.at)});
  return residuals;
}

CorrectedModel::Step CorrectedModel::trust_region_step(const Correction& correction, double radius,
                                                       const CancellationToken& cancellation) const {
  TargetResiduals corrected = residuals(correction);
  const Eigen::VectorXd lower = (correction.at.array() - radius).max(0);
  const Eigen::VectorXd upper = (correction.at.array() + radius).min(1);
  const auto found = numerics::minimize_least_squares(
      corrected, free_parameters(correction.at), free_parameters(lower), free_parameters(upper),
      {.tolerance = 1e-7, .max_iterations = 100, .initial_radius = 1}, Execution{cancellation});
  if (!found.defined) return {correction.at, infinite};
  return {(found.x - lower_).cwiseQuotient(width_), found.norm};
}

double distance_to_nearest(const Eigen::VectorXd& x, const std::vector<Eigen::VectorXd>& others) {
  double nearest = infinite;
  for (const Eigen::VectorXd& other : others) nearest = std::min(nearest, (x - other).cwiseAbs().maxCoeff());
  return nearest;
}

}  // namespace supple::design
