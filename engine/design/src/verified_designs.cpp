#include "supple/design/verified_designs.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <string>
#include <utility>

#include "design_report.h"
#include "design_search.h"
#include "modulus_choice.h"
#include "supple/base/best_so_far.h"
#include "supple/base/error.h"
#include "supple/tiling/definition_text.h"
#include "supple/tiling/structure.h"
#include "supple/tiling/tiling_error.h"

namespace supple::design {
namespace {

struct Simulated {
  Design design;
  Polished polished;
  double deviation() const { return polished.target_error.value_or(std::numeric_limits<double>::infinity()); }
};

std::string why_polished(const VerificationPlan& plan, const Polished& polished) {
  if (plan.polish == Switch::off) return "the request turns it off";
  if (polished.rounds.size() > 1) return "the simulated deviation was beyond the tolerance";
  switch (polished.stopped) {
    case PolishTermination::reached:
      return "the simulated deviation is within the tolerance";
    case PolishTermination::not_simulated:
      return "no design that was tried could be simulated at every sample";
    case PolishTermination::deadline:
    case PolishTermination::memory:
      return std::string(stop_clause(reason_of(polished.stopped)));
    case PolishTermination::no_improvement:
      return "there is no parameter to correct, or nowhere to go";
    default:
      return "the limits of rounds and seconds leave no round";
  }
}

bool differs(const Polished& polished, const Design& design) {
  return polished.parameters != design.parameters || polished.orientation != design.orientation ||
         polished.youngs_modulus != design.youngs_modulus;
}

/// The problem with its modulus fixed at the one that was found.
DesignProblem with_modulus(DesignProblem problem, double modulus) {
  if (!problem.moduli.empty()) problem.moduli = {{modulus, modulus}};
  return problem;
}

std::vector<std::optional<double>> discretization_errors(const Polished& polished, const FamilySimulation& simulation,
                                                         const Execution& execution) {
  const SimulateProfile& coarser = simulation.coarser;
  std::vector<std::optional<double>> errors(polished.targets.size());
  if (!coarser || is_stopped(polished.stopped)) return errors;
  try {
    for (std::size_t t = 0; t < errors.size(); ++t) {
      const Eigen::VectorXd& fine = polished.simulated[t];
      if (!fine.allFinite()) continue;
      const Execution inner{execution.cancellation, nullptr, execution.cost};
      const auto& samples = polished.targets[t].samples;
      const Eigen::VectorXd coarse =
          factor_for(samples.task, polished.stress_factor) * coarser(polished.parameters, samples, inner);
      if (!coarse.allFinite()) continue;
      if (const auto change = relative_difference(fine, coarse)) errors[t] = simulation.error_ratio * *change;
    }
  } catch (const Error&) {
    // A failed estimate does not fail the request.
  } catch (const Cancelled& stop) {
    // The design is answered without the rest of the estimate if time or memory has run out.
    if (!keeps_best(stop.reason())) throw;
    if (stop.reason() == StopReason::memory) execution.cancellation.resume(stop.reason());
  } catch (const std::bad_alloc&) {
    execution.cancellation.resume(StopReason::memory);
    execution.cancellation.throw_if_requested();
  }
  return errors;
}

}  // namespace

VerifiedDesigns verify_designs(std::span<const DesignSpace> spaces, std::span<const FamilySimulation> simulations,
                               const DesignProblem& problem, std::vector<Design> ranking, const DesignOptions& search,
                               const VerificationPlan& plan, const Execution& execution,
                               const std::function<void(const Design&, const PolishRound&)>& on_round) {
  if (ranking.empty()) return {};
  const bool corrects = plan.polish != Switch::off;
  const auto round_of = [&](const Design& design) -> OnPolishRound {
    if (!on_round) return {};
    return [&](const PolishRound& round) { on_round(design, round); };
  };
  PolishOptions simulate_only = plan.options;
  simulate_only.max_rounds = 0;
  const std::size_t simulated_count = corrects ? static_cast<std::size_t>(std::max(plan.families, 1)) : 1;
  std::vector<Simulated> simulated;
  std::vector<Design> others;
  std::optional<PolishTermination> stop;
  for (Design& design : ranking) {
    if (simulated.size() >= simulated_count || stop) {
      others.push_back(std::move(design));
      continue;
    }
    // Without polish the design also keeps its modulus.
    Polished polished = polish(spaces[design.space], corrects ? problem : with_modulus(problem, design.youngs_modulus),
                               OrientedParameters(design.parameters, design.orientation),
                               simulations[design.space].simulate, simulate_only, execution, round_of(design));
    if (!corrects) polished.material = design.material;
    if (is_stopped(polished.stopped)) stop = polished.stopped;
    simulated.push_back({std::move(design), std::move(polished)});
  }
  std::stable_sort(simulated.begin(), simulated.end(),
                   [](const Simulated& a, const Simulated& b) { return a.deviation() < b.deviation(); });
  Simulated& best = simulated.front();
  const auto start = std::chrono::steady_clock::now();
  const bool unfinished = best.polished.stopped == PolishTermination::round_limit ||
                          best.polished.stopped == PolishTermination::not_simulated || stop;
  if (corrects && unfinished) {
    const DesignSpace& space = spaces[best.design.space];
    Polished polished = stop ? best.polished
                             : polish(space, problem, best.polished, simulations[best.design.space].simulate,
                                      plan.options, execution, round_of(best.design));
    if (stop) polished.stopped = *stop;
    best.polished = std::move(polished);
  }
  if (is_simulated(best.polished) && differs(best.polished, best.design)) {
    const DesignProblem fixed_modulus_problem = with_modulus(problem, best.polished.youngs_modulus);
    best.design =
        design_at(spaces[best.design.space], fixed_modulus_problem,
                  OrientedParameters(best.polished.parameters, best.polished.orientation), best.design, search);
    best.design.material = best.polished.material;
  }
  if (execution.cost) {
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    const auto rounds = static_cast<std::int64_t>(best.polished.rounds.size()) - 1;
    execution.cost->add_effect("polish", rounds > 0, why_polished(plan, best.polished), rounds, seconds.count());
  }
  best.design.at_limits = sentences_about_limits(best.design, spaces[best.design.space], problem);
  report_simulation(best.design, best.polished);
  VerifiedDesigns result;
  result.polished = best.polished;
  result.discretization_error = discretization_errors(best.polished, simulations[best.design.space], execution);
  for (Simulated& one : simulated) result.ranking.push_back({std::move(one.design), one.polished.target_error});
  for (Design& design : others) result.ranking.push_back({std::move(design), std::nullopt});
  return result;
}

namespace {

std::shared_ptr<const tiling::Family> family_of(const neural::Model& model) {
  return tiling::family_of(model.family, model.definition);
}

StructureMeasures measures_of(const tiling::Family& family, const Eigen::VectorXd& parameters) {
  const auto structure =
      tiling::make_structure(family, {parameters.data(), static_cast<std::size_t>(parameters.size())});
  return {structure.solid_area / structure.cell_area, std::sqrt(structure.cell_area) / structure.beam_width};
}

void add_measures_or_message(const DesignSpace& space, Design& design) {
  try {
    design.measures = measures_of(*family_of(space.model), design.parameters);
  } catch (const tiling::TilingError& error) {
    design.message +=
        (design.message.empty() ? "" : " ") + ("There is no such structure: " + std::string(error.what()));
  }
}

/// Why the sensitivity to the beam width is not computed; empty if it is.
std::string why_no_sensitivity(const DesignSearch& search, const VerifiedDesigns& found, bool has_tangent) {
  const Design& best = found.ranking.front().design;
  const bool is_verified = found.polished && is_simulated(*found.polished) && !is_stopped(found.polished->stopped);
  if (search.beam_width_sensitivity == Switch::off) return "the request turns it off";
  if (is_stopped(best.stopped)) return "the search was stopped";
  if (search.beam_width_sensitivity == Switch::automatic && !is_verified) return "the design was not simulated";
  if (!best.measures) return "there is no such structure";
  return has_tangent ? "" : "no other beams are simulated";
}

void add_beam_width_sensitivity(const DesignSearch& search, std::span<const FamilySimulation> simulations,
                                VerifiedDesigns& found, const Execution& execution) {
  const Design& best = found.ranking.front().design;
  const bool has_tangent = best.space < simulations.size() && simulations[best.space].rest_tangent;
  const std::string why_not = why_no_sensitivity(search, found, has_tangent);
  const auto start = std::chrono::steady_clock::now();
  if (why_not.empty())
    found.beam_width_sensitivity =
        beam_width_sensitivity(best, simulations[best.space].rest_tangent, {execution.cancellation, nullptr, nullptr});
  if (!execution.cost) return;
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  const bool ran = why_not.empty();
  const char* const why =
      search.beam_width_sensitivity == Switch::on ? "the request asks for it" : "the design was simulated";
  execution.cost->add_effect("beam_width_sensitivity", ran, ran ? why : why_not, ran ? 1 : 0,
                             ran ? seconds.count() : 0);
}

}  // namespace

VerifiedDesigns search_designs(std::span<const DesignSpace> spaces, std::span<const FamilySimulation> simulations,
                               const DesignSearch& search, const Execution& execution, const SearchObserver& observer) {
  auto ranking = find_designs(spaces, search.problem, search.options, execution, observer.on_progress);
  VerifiedDesigns found;
  const DesignTermination stopped = ranking.front().stopped;
  if (search.verification && !is_stopped(stopped)) {
    found = verify_designs(spaces, simulations, search.problem, std::move(ranking), search.options,
                           *search.verification, execution, observer.on_round);
  } else {
    for (Design& design : ranking) found.ranking.push_back({std::move(design), std::nullopt});
    if (execution.cost) {
      execution.cost->add_effect("verification", false,
                                 search.verification
                                     ? std::string(stop_clause(reason_of(stopped))) + " during the search"
                                     : "the request does not ask for it");
      execution.cost->add_effect("polish", false, "designs are corrected where they are verified");
    }
  }
  Design& best = found.ranking.front().design;
  add_measures_or_message(spaces[best.space], best);
  add_beam_width_sensitivity(search, simulations, found, execution);
  return found;
}

DesignSpace design_space(const neural::Model& model, const neural::Evaluator& evaluator, const Candidates& candidates) {
  const auto family = family_of(model);
  return {model, evaluator, candidates,
          [family](const Eigen::VectorXd& parameters) {
            return tiling::can_be_built(*family, {parameters.data(), static_cast<std::size_t>(parameters.size())});
          },
          [family](const Eigen::VectorXd& parameters) { return measures_of(*family, parameters); }};
}

FamilySimulation simulation_of_model(const neural::Model& model) {
  microscale::Material material;
  material.youngs_modulus = model.provenance.youngs_modulus;
  material.poisson_ratio = model.provenance.poisson_ratio;
  return verification_of(*family_of(model), material);
}

}  // namespace supple::design
