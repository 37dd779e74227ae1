#include "design_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <sstream>
#include <string_view>

#include "design_search.h"
#include "free_parameters.h"
#include "supple/base/best_so_far.h"
#include "supple/design/verdict.h"

namespace supple::design {
namespace {

/// Distance from a bound below which the message says that a parameter is at the bound, as a fraction of the bounds'
/// width.
constexpr double bound_fraction = 1e-6;

std::string percent(double fraction) {
  std::ostringstream text;
  text.precision(3);
  text << 100 * fraction << " %";
  return text.str();
}

/// Addition to a sentence about a design that does not reach the target: a design whose deviation counts as reached
/// misses it at some samples only.
std::string_view where_missed(double deviation) {
  return grade_of(deviation) == Grade::reached ? " at every sample" : "";
}

/// A sample in words: a strain, or a direction in degrees.
std::string place(Task task, double x) {
  std::ostringstream text;
  text.precision(3);
  if (task == Task::stress_strain)
    text << "at a strain of " << x;
  else
    text << "at " << x * 180 / std::numbers::pi << " degrees";
  return text.str();
}

/// Sentences about the samples that have weight and are not in range, after `separator`. Empty if all samples are in
/// range.
std::string message_about_trust(const Design& design, const char* separator) {
  long outside = 0;
  long uncertain = 0;
  long samples = 0;
  for (const auto& profile : design.profiles) {
    for (std::size_t i = 0; i < profile.in_range.size(); ++i) {
      if (!profile.target.has_weight(i)) continue;
      ++samples;
      if (profile.in_range[i]) continue;
      const bool has_bar =
          profile.error_bar.size() > 0 && std::isfinite(profile.error_bar[static_cast<Eigen::Index>(i)]);
      ++(has_bar ? uncertain : outside);
    }
  }
  std::ostringstream text;
  if (outside > 0)
    text << separator << outside << " of " << samples << " samples lie outside of what the model was trained on.";
  if (uncertain > 0)
    text << (outside > 0 ? " " : separator) << uncertain << " of " << samples
         << " samples have error bars beyond which the model is not trusted; verify them by simulation.";
  return text.str();
}

/// Whether all values of a target that is missed lie within the envelope. Samples without weight do not count.
bool is_missed_within_envelope(const DesignProfile& profile) {
  if (profile.lowest.size() == 0) return false;
  const SampledTarget& target = profile.target;
  const auto counts = target.weights.array() > 0;
  const auto is_outside = target.y.array() < profile.lowest.array() || target.y.array() > profile.highest.array();
  return !target.is_reached(profile.achieved) && !(counts && is_outside).any();
}

bool is_trusted_at_each_sample(const DesignProfile& profile) {
  for (std::size_t i = 0; i < profile.in_range.size(); ++i)
    if (profile.target.has_weight(i) && profile.in_range[i] == 0) return false;
  return true;
}

}  // namespace

std::string sentences_about_limits(const Design& design, const DesignSpace& space, const DesignProblem& problem) {
  const neural::Network& network = space.model.network;
  std::string text;
  for (const Eigen::Index k : FreeParameters(space, problem).free_of_family()) {
    const double rounding = bound_fraction * (network.upper[k] - network.lower[k]);
    const bool low = design.parameters[k] <= network.lower[k] + rounding;
    if (low || design.parameters[k] >= network.upper[k] - rounding)
      text += " Parameter " + std::to_string(k + 1) + " is at its " + (low ? "lower" : "upper") + " bound.";
  }
  if (problem.moduli.empty()) return text;
  const auto& [min_modulus, max_modulus] = problem.moduli[design.material];
  const bool is_free = min_modulus < max_modulus;
  if (!is_free || (design.youngs_modulus > min_modulus && design.youngs_modulus < max_modulus)) return text;
  return text + " Young's modulus is at its " + (design.youngs_modulus <= min_modulus ? "lower" : "upper") + " limit.";
}

std::string message_about(const Design& design, const neural::Model& model) {
  std::ostringstream text;
  if (!design.reached) {
    const auto& main = design.profiles.front();
    const Eigen::Index worst = main.target.worst_sample(main.achieved);
    const std::string deviation = percent(design.error.relative_rms) + " (root mean square)";
    // The model's mean error does not apply to samples at which the model is not trusted.
    const bool is_trusted = std::all_of(design.profiles.begin(), design.profiles.end(), is_trusted_at_each_sample);
    const auto model_error =
        main.target.samples.task == Task::poisson || !is_trusted ? std::nullopt : neural::mean_stress_error(model);
    if (model_error && design.error.relative_rms <= *model_error)
      text << "The closest design of " << model.family << " that was found deviates by " << deviation
           << ", no more than the model errs in the mean (" << percent(*model_error) << "); most ";
    else
      text << "No design of " << model.family << " that was found reaches the target"
           << where_missed(design.error.relative_rms) << "; the closest deviates by " << deviation << ", most ";
    text << place(main.target.samples.task, main.target.samples.x[static_cast<std::size_t>(worst)]) << ".";
    if (std::any_of(design.profiles.begin(), design.profiles.end(), is_missed_within_envelope))
      text << " Each value of the target is within the envelope, but a curve that has all of them need not exist.";
    text << design.at_limits;
  }
  text << message_about_trust(design, design.reached ? "" : " ");
  return text.str();
}

void report_stop(Design& design, StopReason reason) {
  design.stopped = termination_by(reason);
  design.message += (design.message.empty() ? "" : " ") +
                    stop_sentence(reason, " before the search had ended: this is the best design until then.");
}

StopReason reason_of(PolishTermination stopped) {
  if (stopped == PolishTermination::deadline) return StopReason::deadline;
  return stopped == PolishTermination::memory ? StopReason::memory : StopReason::none;
}

void report_simulation(Design& design, const Polished& polished) {
  if (!polished.target_error) {
    const std::string by_model = design.message.empty() ? "" : " By the model: " + design.message;
    if (is_simulated(polished))
      design.message = "The simulation does not get to every sample." + by_model;
    else
      design.message = stop_sentence(reason_of(polished.stopped), " before the design was simulated." + by_model);
    return;
  }
  bool reached = true;
  for (std::size_t t = 0; t < polished.targets.size(); ++t)
    reached = reached && polished.targets[t].is_reached(polished.simulated[t]);
  if (reached && design.reached) {
    design.message.clear();
  } else {
    std::ostringstream text;
    text << "The simulated structure ";
    if (reached)
      text << "reaches the target";
    else
      text << "does not reach the target" << where_missed(*polished.target_error);
    text << ": it deviates by " << percent(*polished.target_error) << " (root mean square), the model's answer by "
         << percent(design.error.relative_rms) << "." << (reached ? "" : design.at_limits);
    design.message = text.str();
  }
  design.reached = reached;
}

void fill_envelope(DesignProfile& profile, const SampledTarget& coarse, const Eigen::MatrixXd& y) {
  std::vector<double> x;
  std::vector<double> low;
  std::vector<double> high;
  for (Eigen::Index i = 0; i < y.rows(); ++i) {
    double min_value = std::numeric_limits<double>::infinity();
    double max_value = -min_value;
    for (Eigen::Index c = 0; c < y.cols(); ++c) {
      if (!std::isfinite(y(i, c))) continue;
      min_value = std::min(min_value, y(i, c));
      max_value = std::max(max_value, y(i, c));
    }
    if (min_value > max_value) continue;
    x.push_back(coarse.samples.x[static_cast<std::size_t>(i)]);
    low.push_back(min_value);
    high.push_back(max_value);
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
