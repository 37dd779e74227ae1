#include "supple/design/ways_out.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <new>
#include <numbers>
#include <utility>

#include "supple/base/best_so_far.h"
#include "supple/base/number_text.h"
#include "supple/design/verdict.h"
#include "time_limit.h"
#include "ways_out_search.h"

namespace supple::design {
namespace {

using std::numbers::pi;

/// What a way out deviates by at most, as a fraction of the design's deviation. It comes close to the target besides
/// (`max_close_deviation`).
constexpr double max_deviation_ratio = 0.7;
/// Number of starting points of a search, and of that in each of several other families.
constexpr int max_starts_of_way = 6;
constexpr int max_starts_of_family = 3;
/// Ways out need no more accuracy than their sentences say.
constexpr double min_tolerance = 1e-5;
/// A smaller turn is none, rad.
constexpr double min_turn = pi / 180;
/// A smaller relative change of the modulus is none.
constexpr double min_modulus_change = 0.01;
/// The accuracy with which the longest part of a range of strains is found, as a fraction of the range, and the minimum
/// number of samples of the whole range.
constexpr double range_fraction_tolerance = 0.025;
constexpr int min_samples_of_range = 41;
/// Other families that are answered, those with the least expected deviation.
constexpr std::size_t max_families = 3;

/// The largest relative deviation of a target that counts.
double worst_deviation(const DesignProblem& problem, const Design& design) {
  double worst = 0;
  for (std::size_t t = 0; t < design.profiles.size(); ++t) {
    const DesignProfile& profile = design.profiles[t];
    if (problem.targets[t].weight > 0)
      worst = std::max(worst, profile.target.relative_rms(profile.achieved).value_or(INFINITY));
  }
  return worst;
}

/// The same by simulation; infinite if a sample was not reached. None if nothing was simulated.
std::optional<double> worst_simulated_deviation(const DesignProblem& problem,
                                                const std::optional<Polished>& simulated) {
  if (!simulated || !is_simulated(*simulated)) return std::nullopt;
  double worst = 0;
  for (std::size_t t = 0; t < simulated->targets.size(); ++t)
    if (problem.targets[t].weight > 0)
      worst = std::max(worst, simulated->targets[t].relative_rms(simulated->simulated[t]).value_or(INFINITY));
  return worst;
}

/// Whether each target that counts is reached as a whole.
bool reaches_targets(const DesignProblem& problem, const Design& design) {
  for (std::size_t t = 0; t < design.profiles.size(); ++t) {
    const DesignProfile& profile = design.profiles[t];
    if (problem.targets[t].weight > 0 && !is_reached_as_a_whole(profile.target, profile.achieved)) return false;
  }
  return true;
}

/// The same by simulation; none if nothing was simulated.
std::optional<bool> simulation_reaches_targets(const DesignProblem& problem, const std::optional<Polished>& simulated) {
  if (!simulated || !is_simulated(*simulated)) return std::nullopt;
  for (std::size_t t = 0; t < simulated->targets.size(); ++t)
    if (problem.targets[t].weight > 0 && !is_reached_as_a_whole(simulated->targets[t], simulated->simulated[t]))
      return false;
  return true;
}

/// Why no way out is sought; empty if the target is missed.
std::string why_not_sought(const Design& design, bool by_model, const std::optional<bool>& by_simulation) {
  if (is_stopped(design.stopped)) return "the search for the design was stopped";
  if (by_simulation && *by_simulation) return "the target is reached by the simulation";
  return by_model && !by_simulation ? "the target is reached" : "";
}

// --- words -----------------------------------------------------------------------------------------------------------

/// A number with as many significant digits; rounding errors of zero are zero.
std::string rounded_text(double value, int digits) {
  constexpr double zero_tolerance = 1e-9;
  if (std::abs(value) < zero_tolerance) return "0";
  const double unit = std::pow(10, std::floor(std::log10(std::abs(value))) + 1 - digits);
  return number_text(std::round(value / unit) * unit);
}

std::string percent_text(double fraction) {
  constexpr double min_shown = 1e-4;
  return fraction < min_shown ? "less than 0.01 %" : rounded_text(100 * fraction, 2) + " %";
}

}  // namespace

std::string comparison(const Miss& miss, double deviation, Basis basis) {
  const std::string after = percent_text(deviation);
  const std::string before = std::isfinite(miss.deviation) ? " instead of " + percent_text(miss.deviation) : "";
  if (!miss.simulated) return after + before + " by the model";
  const std::string simulated = before.empty() ? "" : before + " by the simulation";
  if (basis == Basis::model) return after + " by the model" + simulated;
  return (basis == Basis::corrected_model ? "about " : "") + after +
         (before.empty() ? " by the simulation" : simulated);
}

std::string words_for_turn(double angle) {
  return fmt::format("{:.0f} degrees{}", std::abs(angle) * 180 / pi, angle < 0 ? " clockwise" : "");
}

std::string words_for_material(const Miss& miss, double modulus) {
  return "a material of " + rounded_text(modulus, 3) + " MPa instead of " +
         rounded_text(miss.design.youngs_modulus, 3) + " MPa";
}

std::string words_for_range(const Target& target, const Range& range) {
  const bool is_one_sided = range.least >= 0 || range.most <= 0;
  return fmt::format("{}strains from {} to {} %: it is reached {}",
                     target.measure == StrainMeasure::green ? "Green " : "", rounded_text(100 * range.least, 3),
                     rounded_text(100 * range.most, 3), is_one_sided ? "up to there" : "between them");
}

// --- kinds of ways out -----------------------------------------------------------------------------------------------

namespace {

/// The same orientation within [0, pi). Responses have the period pi.
double within_half_turn(double orientation) {
  const double angle = orientation - pi * std::floor(orientation / pi);
  return angle < pi ? angle : 0;
}

}  // namespace

WayOut way_to(const Design& design, WayOut::Change change, const DesignProblem& problem) {
  WayOut way;
  way.change = change;
  way.parameters = design.parameters;
  way.orientation = within_half_turn(design.orientation);
  way.youngs_modulus = design.youngs_modulus;
  way.deviation = worst_deviation(problem, design);
  way.uncertainty = design.uncertainty;
  return way;
}

DesignProblem problem_from_design(const Miss& miss) {
  DesignProblem problem = miss.search.problem;
  problem.initial = miss.design.parameters;
  problem.initial_orientation = miss.design.orientation;
  if (!problem.moduli.empty()) problem.moduli = {problem.moduli[miss.design.material]};
  return problem;
}

std::optional<Design> best_design_of(const Miss& miss, const DesignProblem& problem, Switch multi_start) {
  DesignOptions options = miss.options;
  options.multi_start = multi_start;
  try {
    return find_design(miss.search.space, problem, options, miss.execution);
  } catch (const DesignFault&) {
    return std::nullopt;
  }
}

bool may_turn(const Miss& miss) {
  const auto& [least, most] = miss.search.problem.orientation;
  return most - least < pi * (1 - 1e-9);
}

bool may_change_modulus(const Miss& miss) {
  const auto& targets = miss.search.problem.targets;
  const auto& moduli = miss.search.problem.moduli;
  if (std::all_of(targets.begin(), targets.end(), [](const Target& target) { return target.task == Task::poisson; }))
    return false;
  if (moduli.empty()) return true;
  const auto& [least, most] = moduli[miss.design.material];
  return !(miss.design.youngs_modulus > least && miss.design.youngs_modulus < most);
}

void leave_orientation_open(const Miss& miss, DesignProblem& problem) {
  problem.orientation = {miss.design.orientation - pi / 2, miss.design.orientation + pi / 2};
}

bool is_turned(const Miss& miss, const Design& design) {
  return std::abs(design.orientation - miss.design.orientation) >= min_turn;
}

bool is_other_modulus(const Miss& miss, double youngs_modulus) {
  return std::abs(youngs_modulus / miss.design.youngs_modulus - 1) >= min_modulus_change;
}

bool one_suffices(const Ways& ways) {
  return std::any_of(ways.begin(), ways.end(),
                     [](const WayOut& way) { return way.deviation <= max_reached_deviation; });
}

Target shortened_target(const Target& target, const SampledTarget& whole, double fraction) {
  const auto& x = whole.samples.x;
  const double origin = std::clamp(0.0, x.front(), x.back());
  const double rounding = 1e-9 * (x.back() - x.front());
  const double least = origin + fraction * (x.front() - origin) - rounding;
  const double most = origin + fraction * (x.back() - origin) + rounding;
  Target part = target;
  part.interpolation = numerics::Interpolation::linear;
  part.control_points.clear();
  part.weights.clear();
  part.bands.clear();
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (x[i] < least || x[i] > most) continue;
    const auto at = static_cast<Eigen::Index>(i);
    part.control_points.emplace_back(x[i], whole.y[at]);
    part.weights.push_back(whole.weights[at]);
    part.bands.push_back(whole.bands[at]);
  }
  part.samples = static_cast<int>(part.control_points.size());
  return part;
}

namespace {

Ways ways_by_turn(const Miss& miss, const Ways& /*before*/) {
  if (!may_turn(miss)) return {};
  DesignProblem problem = problem_from_design(miss);
  leave_orientation_open(miss, problem);
  const auto design = best_design_of(miss, problem, Switch::automatic);
  if (!design || !is_turned(miss, *design)) return {};
  WayOut way = way_to(*design, WayOut::Change::turn, problem);
  way.sentence =
      fmt::format("Turn the tiling by {}: {}.", words_for_turn(design->orientation - miss.design.orientation),
                  comparison(miss, way.deviation));
  return {way};
}

Ways ways_by_modulus(const Miss& miss, const Ways& /*before*/) {
  if (!may_change_modulus(miss)) return {};
  DesignProblem problem = problem_from_design(miss);
  problem.moduli = {known_moduli};
  const auto design = best_design_of(miss, problem, Switch::automatic);
  if (!design || !is_other_modulus(miss, design->youngs_modulus)) return {};
  WayOut way = way_to(*design, WayOut::Change::modulus, problem);
  way.sentence =
      fmt::format("Use {}: {}.", words_for_material(miss, way.youngs_modulus), comparison(miss, way.deviation));
  return {way};
}

/// Both at once are tried where one of them alone does not reach the target.
Ways ways_by_turn_and_modulus(const Miss& miss, const Ways& before) {
  if (one_suffices(before) || !may_turn(miss) || !may_change_modulus(miss)) return {};
  DesignProblem problem = problem_from_design(miss);
  leave_orientation_open(miss, problem);
  problem.moduli = {known_moduli};
  const auto design = best_design_of(miss, problem, Switch::automatic);
  if (!design || !is_turned(miss, *design) || !is_other_modulus(miss, design->youngs_modulus)) return {};
  WayOut way = way_to(*design, WayOut::Change::turn_and_modulus, problem);
  way.sentence = fmt::format("Turn the tiling by {} and use {}: {}.",
                             words_for_turn(design->orientation - miss.design.orientation),
                             words_for_material(miss, way.youngs_modulus), comparison(miss, way.deviation));
  return {way};
}

/// The longest part of the range that is reached, by bisection.
Ways ways_by_shortening(const Miss& miss, const Ways& /*before*/) {
  const auto& targets = miss.search.problem.targets;
  if (targets.size() > 1 || targets[0].task != Task::stress_strain) return {};
  Target fine = targets[0];
  fine.samples = std::max(fine.samples, min_samples_of_range);
  const SampledTarget whole = sample_target(fine);
  DesignProblem problem = problem_from_design(miss);
  std::optional<WayOut> longest;
  const auto reaches = [&](double fraction) {
    problem.targets = {shortened_target(targets[0], whole, fraction)};
    for (const Switch multi_start : {Switch::off, Switch::automatic}) {
      const auto design = best_design_of(miss, problem, multi_start);
      if (!design || worst_deviation(problem, *design) > max_reached_deviation) continue;
      longest = way_to(*design, WayOut::Change::shorten, problem);
      longest->range = {problem.targets[0].control_points.front()[0], problem.targets[0].control_points.back()[0]};
      problem.initial = design->parameters;
      problem.initial_orientation = design->orientation;
      return true;
    }
    return false;
  };
  double reached_fraction = min_range_fraction;
  double missed_fraction = 1;
  if (!reaches(reached_fraction)) return {};
  while (missed_fraction - reached_fraction > range_fraction_tolerance) {
    const double middle = 0.5 * (reached_fraction + missed_fraction);
    (reaches(middle) ? reached_fraction : missed_fraction) = middle;
  }
  longest->sentence = fmt::format("Shorten the target to {}, {}.", words_for_range(targets[0], *longest->range),
                                  comparison(miss, longest->deviation));
  return {*longest};
}

Ways ways_by_family(const Miss& miss, const Ways& /*before*/) {
  if (miss.search.others.empty()) return {};
  DesignProblem problem = problem_from_design(miss);
  problem.initial.reset();
  problem.initial_orientation.reset();
  problem.fixed.clear();
  DesignOptions options = miss.options;
  options.starts = max_starts_of_family;
  Ways ways;
  try {
    for (const Design& design : find_designs(miss.search.others, problem, options, miss.execution)) {
      if (ways.size() == max_families) break;
      WayOut way = way_to(design, WayOut::Change::family, problem);
      way.other = design.space;
      way.sentence = fmt::format("Use the family {}: {}.", miss.search.others[design.space].model.family,
                                 comparison(miss, way.deviation));
      ways.push_back(std::move(way));
    }
  } catch (const DesignFault&) {
    // No other family has a design.
  }
  return ways;
}

// --- the search ------------------------------------------------------------------------------------------------------

/// Cheapest first.
constexpr std::array<FindWays, 5> kinds{ways_by_turn, ways_by_modulus, ways_by_turn_and_modulus, ways_by_shortening,
                                        ways_by_family};
/// Cheapest first. That the modulus is known exactly serves the search for an orientation.
constexpr std::array<FindWays, 5> kinds_for_simulation{simulated_ways_by_modulus, simulated_ways_by_shortening,
                                                       simulated_ways_by_turn, simulated_ways_by_turn_and_modulus,
                                                       ways_by_family};

bool helps(const Miss& miss, const WayOut& way) {
  return way.deviation <= max_deviation_ratio * miss.deviation &&
         std::hypot(way.deviation, way.uncertainty) < max_close_deviation;
}

/// The options of searches for ways out. A request that says where to begin does not weigh trust, but ways out lead
/// elsewhere.
DesignOptions options_for_ways(const WaysOutSearch& search) {
  DesignOptions options = search.options;
  options.starts = max_starts_of_way;
  options.tolerance = std::max(options.tolerance, min_tolerance);
  options.multi_start = Switch::automatic;
  options.envelope = Switch::off;
  options.trust = options.trust == Switch::off ? Switch::off : Switch::on;
  return options;
}

}  // namespace

std::string_view to_string(WayOut::Change change) {
  switch (change) {
    case WayOut::Change::turn:
      return "turn";
    case WayOut::Change::modulus:
      return "modulus";
    case WayOut::Change::turn_and_modulus:
      return "turn_and_modulus";
    case WayOut::Change::shorten:
      return "shorten";
    case WayOut::Change::family:
      return "family";
  }
  return "";
}

std::vector<WayOut> find_ways_out(const WaysOutSearch& search, const Design& design,
                                  const std::optional<Polished>& simulated, const Execution& execution) {
  const bool is_reached_by_model = reaches_targets(search.problem, design);
  const auto is_reached_by_simulation = simulation_reaches_targets(search.problem, simulated);
  if (const auto why = why_not_sought(design, is_reached_by_model, is_reached_by_simulation); !why.empty()) {
    if (execution.cost) execution.cost->add_effect("ways_out", false, why);
    return {};
  }
  const bool only_simulation = is_reached_by_model;
  const auto start = std::chrono::steady_clock::now();
  const StageTimer timer(execution.cost, "ways_out");
  std::string why = only_simulation ? "the target is missed by the simulation alone" : "the target is missed";
  Ways ways;
  int tried = 0;
  std::string_view cut_short;
  try {
    const TimeLimit limit(execution.cancellation, search.max_seconds);
    const Miss miss{search,
                    design,
                    only_simulation ? *worst_simulated_deviation(search.problem, simulated)
                                    : worst_deviation(search.problem, design),
                    only_simulation ? &*simulated : nullptr,
                    options_for_ways(search),
                    {.cancellation = limit.token()}};
    for (const auto find : only_simulation ? kinds_for_simulation : kinds) {
      execution.cancellation.throw_if_requested();
      limit.token().throw_if_requested();
      if (execution.progress) execution.progress->report(tried / static_cast<double>(kinds.size()), "ways_out");
      for (WayOut& way : find(miss, ways))
        if (helps(miss, way)) ways.push_back(std::move(way));
      ++tried;
    }
    limit.token().throw_if_requested();
  } catch (const Cancelled& stop) {
    if (!keeps_best(stop.reason())) throw;
    // The searches' own token is stopped for `deadline` where the time for ways out has passed.
    const bool is_own_limit = stop.reason() == StopReason::deadline && !execution.cancellation.requested();
    cut_short = is_own_limit ? "the time for it passed" : stop_clause(stop.reason());
  } catch (const std::bad_alloc&) {
    cut_short = stop_clause(StopReason::memory);
  }
  if (!cut_short.empty()) why.append("; ").append(cut_short).append(" before all was tried");
  execution.cancellation.resume(StopReason::memory);
  if (execution.cancellation.reason() != StopReason::deadline) execution.cancellation.throw_if_requested();
  std::stable_sort(ways.begin(), ways.end(),
                   [](const WayOut& a, const WayOut& b) { return a.deviation < b.deviation; });
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  if (execution.cost) execution.cost->add_effect("ways_out", true, why, tried, seconds.count());
  return ways;
}

}  // namespace supple::design
