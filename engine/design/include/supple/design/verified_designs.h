#pragma once

#include <optional>
#include <span>
#include <vector>

#include "supple/design/polish.h"
#include "supple/design/verification.h"

namespace supple::design {

/// What a ranking of designs is simulated for.
struct VerificationPlan {
  /// off: the best design is simulated and stays as it is. automatic, on: it is corrected.
  Switch polish = Switch::automatic;
  PolishOptions options{};
  /// Of several design spaces, so many of the best are simulated before the ranking stands.
  int families = 3;
};

/// One design and its simulation.
struct VerifiedDesign {
  Design design;
  /// Simulated, as DesignError::relative_rms; none where it was not simulated or not at every sample.
  std::optional<double> target_error;
};

struct VerifiedDesigns {
  std::vector<VerifiedDesign> ranking;  ///< those that were simulated first, the least deviation before polishing first
  /// Of the first; its rounds are one where it was not corrected. None where nothing was simulated.
  std::optional<Polished> polished;
  /// For each target, by how much of itself (root mean squares) the first's simulated response changes on the
  /// coarser mesh: what its own mesh errs by at most. None where either simulation does not get to every sample, the
  /// deadline passed, or nobody asked.
  std::vector<std::optional<double>> discretization_error;
};

/// Gives simulation the last word on a ranking of `find_designs`: the best designs of several spaces are ranked by
/// their simulated deviation, and the first of them is polished. A design that cannot be simulated at every sample
/// comes after those that can.
///
/// `simulations` has an entry for each space. With polish off the deadline's error is thrown; otherwise the answer is
/// the best so far. Costs a simulation for each family and each round, and a coarser one of the answer. Bills the
/// effects "polish" and what the simulations bill.
VerifiedDesigns verify_designs(
    std::span<const DesignSpace> spaces, std::span<const FamilySimulation> simulations, const DesignProblem& problem,
    std::vector<Design> ranking, const DesignOptions& search, const VerificationPlan& plan,
    const Execution& execution = {},
    const std::function<void(const Design& design, const PolishRound& round)>& on_round = {});

/// A search and who has its last word.
struct DesignSearch {
  DesignProblem problem;
  DesignOptions options{};
  std::optional<VerificationPlan> verification{};  ///< none: nothing is simulated
};

/// What a search reports on its way.
struct SearchObserver {
  OnProgress on_progress{};
  std::function<void(const Design& design, const PolishRound& round)> on_round{};
};

/// Searches, and simulates what it found: `find_designs`, then `verify_designs` where the search has a plan for it.
/// Without one `polished` and `discretization_error` are empty, `simulations` may be, and the bill says so. Where the
/// best design has no structure, tiles too small or voids closed in a corner of the bounds, its message says so.
VerifiedDesigns search_designs(std::span<const DesignSpace> spaces, std::span<const FamilySimulation> simulations,
                               const DesignSearch& search, const Execution& execution = {},
                               const SearchObserver& observer = {});

/// The space of a model, of parameters that can be built, and the simulation of its structures of their own material.
DesignSpace design_space(const neural::Model& model, const neural::Evaluator& evaluator, const Candidates& candidates);
FamilySimulation simulation_of_model(const neural::Model& model);

}  // namespace supple::design
