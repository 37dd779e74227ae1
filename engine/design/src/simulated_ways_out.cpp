// Ways out where only the simulation misses the target.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "modulus_choice.h"
#include "supple/design/verdict.h"
#include "ways_out_search.h"

namespace supple::design {
namespace {

/// The simulated values of one target at another modulus.
Eigen::VectorXd values_at_modulus(const Miss& miss, std::size_t target, double youngs_modulus) {
  const double factor = youngs_modulus / miss.simulated->youngs_modulus;
  return factor_for(miss.simulated->targets[target].samples.task, factor) * miss.simulated->simulated[target];
}

/// The modulus with which the simulation fits the targets best; none if the simulation does not reach every sample.
std::optional<double> best_modulus(const Miss& miss) {
  if (!std::isfinite(miss.deviation)) return std::nullopt;
  const Polished& simulated = *miss.simulated;
  const double model_modulus = miss.search.space.model.provenance.youngs_modulus;
  std::vector<double> weights;
  Eigen::Index samples = 0;
  for (const SampledTarget& target : simulated.targets) samples += target.y.size();
  Eigen::VectorXd values(samples);
  samples = 0;
  for (std::size_t t = 0; t < simulated.targets.size(); ++t) {
    weights.push_back(miss.search.problem.targets[t].weight);
    values.segment(samples, simulated.targets[t].y.size()) = values_at_modulus(miss, t, model_modulus);
    samples += simulated.targets[t].y.size();
  }
  return ModulusChoice({known_moduli}, model_modulus).best(simulated.targets, weights, values).modulus;
}

/// The problem for the model with the error that the simulation has found at the design, at one modulus.
DesignProblem corrected_problem(const Miss& miss, double youngs_modulus) {
  DesignProblem problem = problem_from_design(miss);
  problem.moduli = {{youngs_modulus, youngs_modulus}};
  const Polished& simulated = *miss.simulated;
  for (std::size_t t = 0; t < problem.targets.size(); ++t) {
    problem.targets[t].samples = static_cast<int>(simulated.targets[t].y.size());
    const double factor = factor_for(problem.targets[t].task, simulated.stress_factor);
    problem.corrections.push_back((simulated.simulated[t] - simulated.model[t]) / factor);
  }
  return problem;
}

/// The best design by the corrected model in any orientation; none if it is not turned.
std::optional<WayOut> turned_way(const Miss& miss, WayOut::Change change, double youngs_modulus) {
  if (!may_turn(miss) || !std::isfinite(miss.deviation)) return std::nullopt;
  DesignProblem problem = corrected_problem(miss, youngs_modulus);
  leave_orientation_open(miss, problem);
  const auto design = best_design_of(miss, problem, Switch::automatic);
  if (!design || !is_turned(miss, *design)) return std::nullopt;
  WayOut way = way_to(*design, change, problem);
  const std::string material =
      change == WayOut::Change::turn ? "" : " and use " + words_for_material(miss, youngs_modulus);
  way.sentence =
      fmt::format("Turn the tiling by {}{}: {}.", words_for_turn(design->orientation - miss.design.orientation),
                  material, comparison(miss, way.deviation, Basis::corrected_model));
  return way;
}

Ways as_ways(std::optional<WayOut> way) { return way ? Ways{*std::move(way)} : Ways{}; }

/// A change that keeps the simulated design. What the model expects of it counts for nothing.
WayOut way_of_same_design(const Miss& miss, WayOut::Change change) {
  WayOut way = way_to(miss.design, change, miss.search.problem);
  way.uncertainty = 0;
  return way;
}

}  // namespace

Ways simulated_ways_by_turn(const Miss& miss, const Ways& /*before*/) {
  return as_ways(turned_way(miss, WayOut::Change::turn, miss.design.youngs_modulus));
}

Ways simulated_ways_by_modulus(const Miss& miss, const Ways& /*before*/) {
  if (!may_change_modulus(miss)) return {};
  const auto modulus = best_modulus(miss);
  if (!modulus || !is_other_modulus(miss, *modulus)) return {};
  WayOut way = way_of_same_design(miss, WayOut::Change::modulus);
  way.youngs_modulus = *modulus;
  way.deviation = 0;
  for (std::size_t t = 0; t < miss.simulated->targets.size(); ++t)
    if (miss.search.problem.targets[t].weight > 0)
      way.deviation =
          std::max(way.deviation,
                   miss.simulated->targets[t].relative_rms(values_at_modulus(miss, t, *modulus)).value_or(INFINITY));
  way.sentence = fmt::format("Use {}: {}.", words_for_material(miss, *modulus),
                             comparison(miss, way.deviation, Basis::simulation));
  return {way};
}

Ways simulated_ways_by_turn_and_modulus(const Miss& miss, const Ways& before) {
  if (one_suffices(before) || !may_change_modulus(miss)) return {};
  const auto modulus = best_modulus(miss);
  if (!modulus || !is_other_modulus(miss, *modulus)) return {};
  return as_ways(turned_way(miss, WayOut::Change::turn_and_modulus, *modulus));
}

/// The longest part of the range between simulated samples that the design reaches.
Ways simulated_ways_by_shortening(const Miss& miss, const Ways& /*before*/) {
  const auto& targets = miss.search.problem.targets;
  if (targets.size() > 1 || targets[0].task != Task::stress_strain) return {};
  const SampledTarget& whole = miss.simulated->targets[0];
  const auto& x = whole.samples.x;
  const double origin = std::clamp(0.0, x.front(), x.back());
  std::vector<double> fractions;
  for (const double strain : x) {
    const double end = strain < origin ? x.front() : x.back();
    if (strain == origin) continue;
    const double fraction = (strain - origin) / (end - origin);
    if (fraction >= min_range_fraction && fraction < 1) fractions.push_back(fraction);
  }
  std::sort(fractions.rbegin(), fractions.rend());
  for (const double fraction : fractions) {
    const Target part = shortened_target(targets[0], whole, fraction);
    if (part.samples < 2) continue;
    const auto first = std::find(x.begin(), x.end(), part.control_points.front()[0]) - x.begin();
    const auto deviation = sample_target(part).relative_rms(miss.simulated->simulated[0].segment(first, part.samples));
    if (!deviation || *deviation > max_reached_deviation) continue;
    WayOut way = way_of_same_design(miss, WayOut::Change::shorten);
    way.range = {part.control_points.front()[0], part.control_points.back()[0]};
    way.deviation = *deviation;
    way.sentence = fmt::format("Shorten the target to {}, {}.", words_for_range(targets[0], *way.range),
                               comparison(miss, way.deviation, Basis::simulation));
    return {way};
  }
  return {};
}

}  // namespace supple::design
