#include "modulus_choice.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "supple/base/number_text.h"
#include "supple/design/design_fault.h"

namespace supple::design {
namespace {

/// Sum of the weighted squared deviations beyond the bands, as a function of the factor. It is convex, and quadratic
/// between the factors at which a sample enters or leaves its band. `slope` is half of its first derivative,
/// `curvature` half of its second.
struct Misfit {
  double value = 0;
  double slope = 0;
  double curvature = 0;
};

/// Calls visit(weight, sample, value, deviation) for each sample whose value depends on the modulus.
template <class Visit>
void for_each_stress(const std::vector<SampledTarget>& targets, const std::vector<double>& target_weights,
                     const Eigen::VectorXd& values, double factor, Visit&& visit) {
  Eigen::Index first = 0;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    const SampledTarget& target = targets[t];
    const Eigen::Index n = target.y.size();
    if (target.samples.task != Task::poisson) {
      const Eigen::VectorXd deviations = target.deviations(factor * values.segment(first, n));
      const double target_factor = target_weights[t] / (target.scale * target.scale);
      // Samples without an equilibrium do not count.
      for (Eigen::Index i = 0; i < n; ++i)
        if (std::isfinite(deviations[i]))
          visit(target_factor * target.weights[i], first + i, values[first + i], deviations[i]);
    }
    first += n;
  }
}

Misfit misfit(const std::vector<SampledTarget>& targets, const std::vector<double>& target_weights,
              const Eigen::VectorXd& values, double factor) {
  Misfit sum;
  for_each_stress(targets, target_weights, values, factor,
                  [&](double weight, Eigen::Index, double value, double deviation) {
                    sum.value += weight * deviation * deviation;
                    if (deviation == 0) return;
                    sum.slope += weight * value * deviation;
                    sum.curvature += weight * value * value;
                  });
  return sum;
}

/// The factor between `low` and `high` with the least misfit: the root of its slope, by Newton's method within a
/// bracket that shrinks with each step. The slope is piecewise linear, so that few steps reach rounding accuracy.
template <class MisfitAt>
double minimize_between(double low, double high, const MisfitAt& misfit_at) {
  if (!(misfit_at(low).slope < 0)) return low;
  if (!(misfit_at(high).slope > 0)) return high;
  constexpr int max_steps = 60;
  double factor = 0.5 * (low + high);
  for (int step = 0; step < max_steps; ++step) {
    const Misfit at = misfit_at(factor);
    if (at.slope == 0) return factor;
    (at.slope < 0 ? low : high) = factor;
    double next = at.curvature > 0 ? factor - at.slope / at.curvature : low;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (next == factor || next <= low || next >= high) return next;
    factor = next;
  }
  return factor;
}

}  // namespace

ModulusChoice::ModulusChoice(const std::vector<Range>& moduli, double model_modulus)
    : moduli_(moduli.empty() ? std::vector<Range>{{model_modulus, model_modulus}} : moduli),
      model_modulus_(model_modulus) {
  for (std::size_t i = 0; i < moduli_.size(); ++i) {
    const auto [min_modulus, max_modulus] = moduli_[i];
    if (min_modulus > 0 && min_modulus <= max_modulus && std::isfinite(max_modulus)) continue;
    const std::string text =
        "must be positive and not decrease, got " + number_text(min_modulus) + " to " + number_text(max_modulus);
    throw DesignFault("design.invalid_modulus", "The range of Young's modulus " + text + ".",
                      {{"moduli/" + std::to_string(i), text}});
  }
}

ModulusChoice::Chosen ModulusChoice::best(const std::vector<SampledTarget>& targets,
                                          const std::vector<double>& target_weights,
                                          const Eigen::VectorXd& values) const {
  const auto misfit_at = [&](double factor) { return misfit(targets, target_weights, values, factor); };
  Chosen chosen;
  double min_misfit = 0;
  for (std::size_t i = 0; i < moduli_.size(); ++i) {
    const double low = moduli_[i].least / model_modulus_;
    const double high = moduli_[i].most / model_modulus_;
    const double factor = low < high ? minimize_between(low, high, misfit_at) : low;
    const double value = moduli_.size() > 1 ? misfit_at(factor).value : 0;
    if (i > 0 && !(value < min_misfit)) continue;
    min_misfit = value;
    chosen = {i, factor * model_modulus_, factor, factor > low && factor < high};
    // At a limit the modulus is exactly the limit, without the rounding of the product.
    if (!chosen.is_inside) chosen.modulus = factor == low ? moduli_[i].least : moduli_[i].most;
  }
  return chosen;
}

Eigen::RowVectorXd ModulusChoice::slope(const std::vector<SampledTarget>& targets,
                                        const std::vector<double>& target_weights, const Eigen::VectorXd& values,
                                        const Eigen::MatrixXd& derivatives, const Chosen& chosen) const {
  Eigen::RowVectorXd slope = Eigen::RowVectorXd::Zero(derivatives.cols());
  if (!chosen.is_inside) return slope;
  double curvature = 0;
  for_each_stress(targets, target_weights, values, chosen.factor,
                  [&](double weight, Eigen::Index sample, double value, double deviation) {
                    if (deviation == 0) return;
                    slope -= weight * (deviation + chosen.factor * value) * derivatives.row(sample);
                    curvature += weight * value * value;
                  });
  if (!(curvature > 0)) return Eigen::RowVectorXd::Zero(derivatives.cols());
  return slope / curvature;
}

std::pair<double, double> ModulusChoice::limits() const {
  double min_modulus = moduli_.front().least;
  double max_modulus = moduli_.front().most;
  for (const Range& range : moduli_) {
    min_modulus = std::min(min_modulus, range.least);
    max_modulus = std::max(max_modulus, range.most);
  }
  return {min_modulus / model_modulus_, max_modulus / model_modulus_};
}

std::optional<double> ModulusChoice::single() const {
  const auto [min_factor, max_factor] = limits();
  return min_factor == max_factor ? std::optional(min_factor) : std::nullopt;
}

Eigen::VectorXd scaled(const std::vector<SampledTarget>& targets, Eigen::VectorXd values, double factor) {
  Eigen::Index first = 0;
  for (const SampledTarget& target : targets) {
    values.segment(first, target.y.size()) *= factor_for(target.samples.task, factor);
    first += target.y.size();
  }
  return values;
}

}  // namespace supple::design
