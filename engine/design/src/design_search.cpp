// The search for the best design of one family.
#include <cmath>
#include <exception>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "best_design.h"
#include "design_report.h"
#include "design_search.h"
#include "local_search.h"
#include "ranked_candidates.h"
#include "search_problem.h"
#include "search_steps.h"
#include "supple/base/best_so_far.h"
#include "supple/base/error.h"
#include "supple/base/part_of_execution.h"

namespace supple::design {
namespace {

/// A search that was stopped has no time or memory for further candidates.
void add_envelope(Design& design, const SearchProblem& problem, RankedCandidates& candidates,
                  const Execution& execution) {
  const Switch requested = problem.options.envelope;
  const bool too_late = is_stopped(design.stopped) && !candidates.are_evaluated();
  const bool wanted =
      !too_late && (requested == Switch::on || (requested == Switch::automatic && candidates.are_evaluated()));
  if (execution.cost)
    execution.cost->add_effect("envelope", wanted,
                               requested == Switch::off     ? "the request leaves it out"
                               : too_late                   ? "the search was stopped before"
                               : requested == Switch::on    ? "the request asks for it"
                               : candidates.are_evaluated() ? "candidates were evaluated"
                                                            : "no candidates were evaluated",
                               wanted ? 1 : 0);
  if (!wanted) return;
  candidates.evaluate(execution);
  Eigen::Index at = 0;
  for (std::size_t t = 0; t < problem.targets.size(); ++t) {
    const auto n = candidates.targets()[t].y.size();
    const auto [min_factor, max_factor] = problem.materials.limits();
    const Task task = candidates.targets()[t].samples.task;
    Eigen::MatrixXd y(n, 2 * candidates.count());
    for (Eigen::Index c = 0; c < candidates.count(); ++c) {
      const Eigen::VectorXd values = candidates.values(c).segment(at, n);
      y.col(2 * c) = factor_for(task, min_factor) * values;
      y.col(2 * c + 1) = factor_for(task, max_factor) * values;
    }
    fill_envelope(design.profiles[t], candidates.targets()[t], y);
    at += n;
  }
}

void bill_multi_start(const SearchProblem& problem, bool ran, int starts, CostLedger& cost) {
  const Switch requested = problem.options.multi_start;
  const char* why = "the request turns it off";
  if (problem.bounds.free.empty())
    why = "no parameter is free";
  else if (requested == Switch::on)
    why = "the request asks for it";
  else if (!problem.problem.initial)
    why = "the request has no initial parameters";
  else if (requested == Switch::automatic)
    why = ran ? "the design found from the initial parameters does not reach the target well"
              : "the design found from the initial parameters reaches the target";
  cost.add_effect("multi_start", ran, why, starts);
}

void bill_choices(const SearchProblem& problem, bool trust_has_chosen, const TrustEffort& trust, CostLedger& cost) {
  const bool has_choice = !problem.materials.single();
  cost.add_effect("modulus", has_choice, has_choice ? "the request leaves a choice" : "the request leaves no choice");
  const bool turns = problem.bounds.orientation_is_free();
  cost.add_effect("orientation", turns, turns ? "the request leaves a range" : "the request leaves no choice");
  if (problem.space.model.calibration)
    cost.add_effect("trust", trust_has_chosen,
                    problem.options.trust == Switch::off ? "the request turns it off"
                    : !problem.weighs_trust()            ? "the request says where to begin"
                    : trust_has_chosen ? "the model's error bars are long at a design that seems nearer"
                                       : "the nearest design is trusted as much as any",
                    trust.evaluations, trust.seconds);
  const bool limited = problem.limits.are_needed();
  cost.add_effect("limits", limited, limited ? "the request has limits" : "the request has none");
}

/// Searches for one material from several starting points. `materials` are the ranges of all materials.
Design search(const DesignSpace& space, const DesignProblem& one_material, const DesignOptions& options,
              const ModulusChoice& materials, const Execution& execution, const OnProgress& progress) {
  const SearchProblem problem(space, one_material, options, materials);
  RankedCandidates candidates(problem);
  SearchCounts counts;
  BestDesign best(problem, counts);
  LocalSearch local(problem, candidates, best, counts, execution, progress);
  const SearchState state{problem, candidates, best, counts};
  const StageTimer timer(execution.cost, "optimization");
  const FreeParameters& bounds = problem.bounds;
  const bool all_fixed = bounds.free.empty();
  const bool no_further_starts = all_fixed || options.multi_start == Switch::off;
  TrustEffort trust;
  const StopReason stop = part_until_stopped(
      execution.cancellation, [&] { return local.keep_best_state(); },
      [&] {
        if (one_material.initial || all_fixed)
          local.search_from(all_fixed ? bounds.fixed_values : problem.requested_start());
        if (counts.starts == 0 || (!no_further_starts && (options.multi_start == Switch::on || !best.is_good())))
          search_from_candidates(state, local, execution);
        if (best.is_found() && best.is_uncertain() && !no_further_starts)
          trust = search_trusted_designs(state, execution);
      });
  Design design = best.get();
  if (stop != StopReason::none) design.stopped = termination_by(stop);
  design.starts = counts.starts;
  design.iterations = counts.iterations;
  design.evaluations = counts.evaluations;
  for (std::size_t t = 0; t < design.profiles.size(); ++t) design.profiles[t].initial = local.initial_profiles()[t];
  if (execution.cost) bill_multi_start(problem, candidates.are_evaluated(), counts.starts, *execution.cost);
  add_envelope(design, problem, candidates, execution);
  design.at_limits = sentences_about_limits(design, space, one_material);
  design.message = message_about(design, space.model);
  if (stop != StopReason::none) report_stop(design, stop);
  design.model_error = neural::mean_stress_error(space.model);
  if (execution.cost) {
    bill_choices(problem, best.min_deviation() < design.error.relative_rms, trust, *execution.cost);
    execution.cost->add_quantity("evaluations", static_cast<double>(counts.evaluations));
    execution.cost->add_quantity("iterations", counts.iterations);
    execution.cost->add_quantity("restarts", static_cast<double>(counts.restarts));
  }
  return design;
}

/// Adds the counts of another search to those of the best design.
void add_counts(Design& best, const Design& other) {
  best.iterations += other.iterations;
  best.starts += other.starts;
  best.evaluations += other.evaluations;
}

/// The best design of several materials. Each material has a search of its own. A search that chose the material at
/// every step would end where two materials are equally good, and its starting points would be those of the materials
/// that fit best far from a minimum. The first material whose design reaches the target and is trusted ends the search.
Design best_of_materials(const DesignSpace& space, const DesignProblem& problem, const DesignOptions& options,
                         const ModulusChoice& materials, const Execution& execution, const OnProgress& progress) {
  std::optional<Design> best;
  std::exception_ptr refusal;
  double min_reported_deviation = std::numeric_limits<double>::infinity();
  OnProgress improvements;
  if (progress)
    improvements = [&](const DesignProgress& update) {
      if (update.error.relative_rms >= min_reported_deviation) return;
      min_reported_deviation = update.error.relative_rms;
      progress(update);
    };
  const std::size_t count = problem.moduli.size();
  StopReason stop = StopReason::none;
  for (std::size_t i = 0; i < count && stop == StopReason::none; ++i) {
    const double fraction = 1 / static_cast<double>(count);
    const PartOfExecution part(execution, fraction * static_cast<double>(i), fraction);
    DesignProblem single_material_problem = problem;
    single_material_problem.moduli = {problem.moduli[i]};
    try {
      std::optional<Design> found;
      stop = part_until_stopped(
          execution.cancellation, [&] { return best.has_value(); },
          [&] { found = search(space, single_material_problem, options, materials, part.execution(), improvements); });
      if (!found) break;
      Design design = *std::move(found);
      design.material = i;
      stop = reason_of(design.stopped);
      const auto merit = [](const Design& candidate) {
        return std::hypot(candidate.error.relative_rms, candidate.uncertainty);
      };
      const bool is_better = !best || merit(design) < merit(*best);
      if (best) add_counts(is_better ? design : *best, is_better ? *best : design);
      if (is_better) best = std::move(design);
    } catch (const NoDesign&) {
      if (!refusal) refusal = std::current_exception();
    }
    const bool is_good = best && best->reached && best->error.relative_rms <= good_deviation && best->uncertainty == 0;
    if (is_good && options.multi_start != Switch::on) break;
  }
  if (!best) std::rethrow_exception(refusal);
  if (stop != StopReason::none && !is_stopped(best->stopped)) report_stop(*best, stop);
  return *std::move(best);
}

}  // namespace

StopReason reason_of(DesignTermination stopped) {
  if (stopped == DesignTermination::deadline) return StopReason::deadline;
  return stopped == DesignTermination::memory ? StopReason::memory : StopReason::none;
}

DesignTermination termination_by(StopReason reason) {
  return reason == StopReason::memory ? DesignTermination::memory : DesignTermination::deadline;
}

Design search_design(const DesignSpace& space, const DesignProblem& problem, const DesignOptions& options,
                     const Execution& execution, const OnProgress& progress) {
  const ModulusChoice materials(problem.moduli, space.model.provenance.youngs_modulus);
  if (problem.moduli.size() > 1) return best_of_materials(space, problem, options, materials, execution, progress);
  return search(space, problem, options, materials, execution, progress);
}

Design find_design(const DesignSpace& space, const DesignProblem& problem, const DesignOptions& options,
                   const Execution& execution, const OnProgress& progress) {
  Design design = search_design(space, problem, options, execution, progress);
  if (is_stopped(design.stopped)) execution.cancellation.resume(reason_of(design.stopped));
  return design;
}

}  // namespace supple::design
