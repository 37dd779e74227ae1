#include "profile_trust.h"

#include <cmath>
#include <limits>

namespace supple::design {
namespace {

/// Length of an error bar in standard deviations, if errors are normally distributed. An error bar covers nine of ten
/// errors, and so do 1.645 standard deviations.
constexpr double standard_deviations_per_bar = 1.645;

/// The kind of error bar that belongs to a task's values.
neural::Quantity quantity_of(Task task) {
  switch (task) {
    case Task::stiffness:
      return neural::Quantity::stiffness;
    case Task::poisson:
      return neural::Quantity::poisson;
    default:
      return neural::Quantity::stress;
  }
}

}  // namespace

ProfileTrust profile_trust(const neural::Model& model, const neural::ErrorBars& bars,
                           const std::vector<Sample>& samples, const Equilibria<double>& equilibria, std::size_t first,
                           const Eigen::VectorXd& values) {
  ProfileTrust result;
  result.in_range.resize(static_cast<std::size_t>(values.size()));
  if (model.calibration) result.error_bar.setConstant(values.size(), std::numeric_limits<double>::quiet_NaN());
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const std::size_t at = first + static_cast<std::size_t>(i);
    const Equilibrium& state = equilibria[at];
    if (!state.converged) continue;
    const auto& sample = samples[at];
    const auto trust =
        bars.uniaxial(quantity_of(sample.task), equilibria.frame(at), sample.loading.strain, state.strain, state);
    result.in_range[static_cast<std::size_t>(i)] = trust.in_range;
    // Error bars of Poisson's ratio are absolute, and those of stress and stiffness are relative to the value.
    if (trust.error) result.error_bar[i] = *trust.error * (sample.task == Task::poisson ? 1 : std::abs(values[i]));
  }
  return result;
}

Uncertainty uncertainty_of(const std::vector<SampledTarget>& targets, const std::vector<double>& weights,
                           const std::vector<ProfileTrust>& trusts) {
  Uncertainty uncertainty;
  double sum = 0;
  double total = 0;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    const ProfileTrust& trust = trusts[t];
    for (std::size_t i = 0; i < trust.in_range.size(); ++i) {
      if (trust.in_range[i] != 0) continue;
      const auto at = static_cast<Eigen::Index>(i);
      const bool has_bar = trust.error_bar.size() > 0 && std::isfinite(trust.error_bar[at]);
      uncertainty.has_long_bars = uncertainty.has_long_bars || has_bar;
      const double error = has_bar ? trust.error_bar[at] / (standard_deviations_per_bar * targets[t].scale) : 1;
      sum += weights[t] * targets[t].weights[at] * error * error;
    }
    total += weights[t];
  }
  uncertainty.size = std::sqrt(sum / total);
  return uncertainty;
}

}  // namespace supple::design
