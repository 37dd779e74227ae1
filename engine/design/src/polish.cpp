#include "supple/design/polish.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "polish_rounds.h"
#include "polish_starts.h"
#include "supple/base/best_so_far.h"
#include "supple/base/error.h"
#include "trust_region_descent.h"

namespace supple::design {
namespace {

/// Descends from a simulated design, then from other minima of the corrected network, then from surveyed designs.
PolishTermination improve(PolishRounds& rounds, OtherStarts other_starts, SimulatedDesign design) {
  SurveyedStarts surveyed_starts(rounds);
  while (true) {
    if (std::isfinite(design.deviation)) {
      if (const auto termination = TrustRegionDescent(rounds, design).run()) return *termination;
    }
    for (bool found = false; !found;) {
      if (const auto termination = rounds.termination()) return *termination;
      if (const auto start = other_starts.next()) {
        design = rounds.simulate(Proposal::new_search, *start);
        found = std::isfinite(design.deviation);
      } else if (const auto point = surveyed_starts.next()) {
        // A design that does not improve still extends the field of corrections, with which the next point is chosen.
        const double before = rounds.best().deviation;
        design = rounds.simulate(Proposal::survey, *point);
        found = design.deviation < before;
        surveyed_starts.count(found);
      } else {
        return PolishTermination::no_improvement;
      }
    }
  }
}

/// Improves the design that `first` simulates or knows.
template <class First>
Polished improved(const DesignSpace& space, PolishRounds& rounds, const Execution& execution, const First& first) {
  PolishTermination termination = PolishTermination::reached;
  const StopReason stop = part_until_stopped(
      execution.cancellation, [&] { return rounds.count() > 0; },
      [&] { termination = improve(rounds, OtherStarts(space, rounds), first()); });
  if (stop == StopReason::deadline) termination = PolishTermination::deadline;
  // The memory of a simulation that was stopped is free again, so that what follows may take as much as it needs, ways
  // out among others. A deadline that has passed stays requested: what follows and takes time then ends at once, and
  // only the report is left, which does not check for a stop.
  if (stop == StopReason::memory) {
    execution.cancellation.resume(stop);
    termination = PolishTermination::memory;
  }
  return rounds.result(termination);
}

}  // namespace

std::string_view to_string(PolishTermination termination) {
  switch (termination) {
    case PolishTermination::reached:
      return "reached";
    case PolishTermination::no_improvement:
      return "no_improvement";
    case PolishTermination::round_limit:
      return "round_limit";
    case PolishTermination::time_limit:
      return "time_limit";
    case PolishTermination::deadline:
      return "deadline";
    case PolishTermination::memory:
      return "memory";
    case PolishTermination::not_simulated:
      return "not_simulated";
  }
  return "";
}

std::string_view to_string(Proposal proposal) {
  switch (proposal) {
    case Proposal::search:
      return "search";
    case Proposal::step:
      return "step";
    case Proposal::probe:
      return "probe";
    case Proposal::new_search:
      return "new_search";
    case Proposal::survey:
      return "survey";
  }
  return "";
}

bool is_simulated(const Polished& polished) {
  return !is_stopped(polished.stopped) ||
         std::any_of(polished.simulated.begin(), polished.simulated.end(),
                     [](const Eigen::VectorXd& values) { return values.array().isFinite().any(); });
}

Polished polish(const DesignSpace& space, const DesignProblem& problem, const OrientedParameters& found,
                const SimulateProfile& simulate, const PolishOptions& options, const Execution& execution,
                const OnPolishRound& on_round) {
  PolishRounds rounds(space, problem, simulate, options, execution, on_round);
  return improved(space, rounds, execution,
                  [&] { return rounds.simulate_found(FreeParameters::all_of(found.parameters, found.orientation)); });
}

Polished polish(const DesignSpace& space, const DesignProblem& problem, const Polished& before,
                const SimulateProfile& simulate, const PolishOptions& options, const Execution& execution,
                const OnPolishRound& on_round) {
  PolishRounds rounds(space, problem, simulate, options, execution, on_round);
  rounds.resume(before);
  return improved(space, rounds, execution, [&] { return rounds.best(); });
}

Design design_at(const DesignSpace& space, const DesignProblem& problem, const OrientedParameters& at,
                 const Design& found, const DesignOptions& options) {
  DesignProblem all_fixed = problem;
  all_fixed.orientation = {at.orientation, at.orientation};
  all_fixed.initial.reset();
  all_fixed.fixed.clear();
  for (const double value : at.parameters) all_fixed.fixed.emplace_back(value);
  DesignOptions plain = options;
  plain.envelope = Switch::off;
  Design design = find_design(space, all_fixed, plain);
  design.space = found.space;
  design.iterations = found.iterations;
  design.starts = found.starts;
  design.stopped = found.stopped;
  design.evaluations += found.evaluations;
  for (std::size_t t = 0; t < design.profiles.size(); ++t) {
    DesignProfile& profile = design.profiles[t];
    const DesignProfile& before = found.profiles[t];
    profile.initial = before.initial;
    if (before.lowest.size() == 0) continue;
    profile.lowest = before.lowest.cwiseMin(profile.achieved);
    profile.highest = before.highest.cwiseMax(profile.achieved);
  }
  return design;
}

}  // namespace supple::design
