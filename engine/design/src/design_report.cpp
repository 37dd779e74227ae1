#include "design_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <sstream>

namespace supple::design {
namespace {

/// How close to a bound a parameter is called at it, as a share of the bounds' widths.
constexpr double bound_share = 1e-6;

std::string percent(double share) {
  std::ostringstream text;
  text.precision(3);
  text << 100 * share << " %";
  return text.str();
}

}  // namespace

std::string message_about(const Design& design, const neural::Model& model, const std::vector<Eigen::Index>& free) {
  std::ostringstream text;
  if (!design.reached) {
    const auto& main = design.profiles.front();
    Eigen::Index worst = 0;
    main.target.deviations(main.achieved).cwiseAbs().maxCoeff(&worst);
    text << "No design of " << model.family << " that was found reaches the target; the closest deviates by "
         << percent(design.error.relative_rms)
         << " (root mean square), most at x = " << main.target.samples.x[static_cast<std::size_t>(worst)] << ".";
    for (const Eigen::Index k : free) {
      const double rounding = bound_share * (model.network.upper[k] - model.network.lower[k]);
      const bool low = design.parameters[k] <= model.network.lower[k] + rounding;
      if (low || design.parameters[k] >= model.network.upper[k] - rounding)
        text << " Parameter " << k + 1 << " is at its " << (low ? "lower" : "upper") << " bound.";
    }
  }
  long outside = 0;
  long samples = 0;
  for (const auto& profile : design.profiles) {
    outside += std::count(profile.in_range.begin(), profile.in_range.end(), 0);
    samples += static_cast<long>(profile.in_range.size());
  }
  if (outside > 0)
    text << (design.reached ? "" : " ") << outside << " of " << samples
         << " samples lie outside of what the model was trained on.";
  return text.str();
}

void bound_profile(DesignProfile& profile, const SampledTarget& coarse, const Eigen::MatrixXd& y) {
  std::vector<double> x;
  std::vector<double> low;
  std::vector<double> high;
  for (Eigen::Index i = 0; i < y.rows(); ++i) {
    double least = std::numeric_limits<double>::infinity();
    double most = -least;
    for (Eigen::Index c = 0; c < y.cols(); ++c) {
      if (!std::isfinite(y(i, c))) continue;
      least = std::min(least, y(i, c));
      most = std::max(most, y(i, c));
    }
    if (least > most) continue;
    x.push_back(coarse.samples.x[static_cast<std::size_t>(i)]);
    low.push_back(least);
    high.push_back(most);
  }
  if (x.empty()) return;
  const std::optional<double> period =
      coarse.samples.task == Task::stress_strain ? std::nullopt : std::optional(std::numbers::pi);
  const numerics::Interpolant lowest(x, low, numerics::Interpolation::monotone, period);
  const numerics::Interpolant highest(x, high, numerics::Interpolation::monotone, period);
  const auto& at = profile.target.samples.x;
  profile.lowest.resize(profile.achieved.size());
  profile.highest.resize(profile.achieved.size());
  for (Eigen::Index i = 0; i < profile.achieved.size(); ++i) {
    profile.lowest[i] = std::min(lowest(at[static_cast<std::size_t>(i)]), profile.achieved[i]);
    profile.highest[i] = std::max(highest(at[static_cast<std::size_t>(i)]), profile.achieved[i]);
  }
}

}  // namespace supple::design
