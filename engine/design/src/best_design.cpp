#include "best_design.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "supple/base/error.h"

namespace supple::design {

double BestDesign::compare(const Eigen::VectorXd& x, DesignTermination stopped) {
  auto residuals = problem_.exact_residuals();
  Eigen::VectorXd r;
  const bool defined = residuals.residuals(x, r);
  counts_.add(residuals);
  if (!defined) return std::numeric_limits<double>::infinity();
  const double deviation = r.norm();
  // The merit is at least the deviation, so that most designs need no error bars.
  if (found_ && deviation >= merit_) return deviation;
  if (keep_if_beyond_limits(residuals.last_parameters(), deviation)) return deviation;
  std::vector<ProfileTrust> trusts;
  const auto origin = problem_.bounds.free.empty() ? neural::Origin::given : neural::Origin::searched;
  for (std::size_t t = 0; t < problem_.targets.size(); ++t)
    trusts.push_back(residuals.trust(problem_.space.model, t, origin));
  const Uncertainty uncertainty =
      problem_.weighs_trust() ? uncertainty_of(problem_.targets, problem_.weights, trusts) : Uncertainty{};
  min_deviation_ = std::min(min_deviation_, deviation);
  const double merit = std::hypot(deviation, uncertainty.size);
  if (found_ && merit >= merit_) return deviation;
  merit_ = merit;
  best_.uncertainty = uncertainty.size;
  is_uncertain_ = uncertainty.has_long_bars;
  found_ = true;
  replace(residuals, deviation, stopped, std::move(trusts));
  return deviation;
}

/// Keeps the violated limits of a design if it comes closest to the targets. If all parameters are fixed, the design is
/// described even if it violates the limits.
bool BestDesign::keep_if_beyond_limits(const Eigen::VectorXd& parameters, double deviation) {
  if (problem_.bounds.free.empty()) return false;
  auto beyond = excess(problem_.space, problem_.problem.limits, family_part(parameters));
  if (beyond.empty()) return false;
  if (!beyond_limits_ || deviation < deviation_beyond_limits_) {
    deviation_beyond_limits_ = deviation;
    beyond_limits_ = std::move(beyond);
  }
  return true;
}

void BestDesign::replace(const TargetResiduals& residuals, double deviation, DesignTermination stopped,
                         std::vector<ProfileTrust> trusts) {
  const auto& targets = problem_.targets;
  best_.parameters = family_part(residuals.last_parameters());
  best_.orientation = orientation_in(residuals.last_parameters());
  best_.material = residuals.chosen().material;
  best_.youngs_modulus = residuals.chosen().modulus;
  best_.stopped = stopped;
  best_.residual = residuals.largest_residual();
  best_.error = {deviation, 0};
  best_.reached = true;
  best_.profiles.resize(targets.size());
  for (std::size_t t = 0; t < targets.size(); ++t) {
    auto& profile = best_.profiles[t];
    profile.target = targets[t];
    profile.target.samples.orientation = best_.orientation;
    profile.achieved = residuals.values(t);
    profile.in_range = std::move(trusts[t].in_range);
    profile.error_bar = std::move(trusts[t].error_bar);
    if (t == 0)
      best_.error.max = std::abs(targets[t].deviations(profile.achieved)[targets[t].worst_sample(profile.achieved)]);
    profile.reached = targets[t].reached(profile.achieved);
    best_.reached = best_.reached && targets[t].is_reached(profile.achieved);
  }
}

bool BestDesign::is_good() const {
  return best_.reached && best_.error.relative_rms <= good_deviation && !is_uncertain_;
}

const Design& BestDesign::get() const {
  if (found_) return best_;
  const std::string& family = problem_.space.model.family;
  if (beyond_limits_)
    throw BeyondLimits(
        "design.beyond_limits",
        "No design of the family " + family +
            " that was tried keeps within the limits. Of the one that comes closest to the target, this is "
            "beyond them: " +
            *beyond_limits_,
        {{"limits", *beyond_limits_}});
  throw NoDesign("design.no_equilibrium",
                 "No design of the family " + family +
                     " that was tried can be built and has an equilibrium at every sample of the targets.");
}

}  // namespace supple::design
