#pragma once

#include <optional>
#include <span>
#include <vector>

#include "supple/design/polish.h"
#include "supple/design/verification.h"

namespace supple::design {

/// How a ranking of designs is simulated.
struct VerificationPlan {
  /// off simulates the best design and leaves it as it is. automatic and on also correct it.
  Switch polish = Switch::automatic;
  PolishOptions options{};
  /// With several design spaces, so many of the best designs are simulated before the ranking is final.
  int families = 3;
};

/// One design and its simulation.
struct VerifiedDesign {
  Design design;
  /// Simulated deviation, as DesignError::relative_rms. None if the design was not simulated at every sample.
  std::optional<double> target_error;
};

struct VerifiedDesigns {
  /// Designs that were simulated come first, ordered by their deviation before they were polished.
  std::vector<VerifiedDesign> ranking;
  /// The polish of the first design, which has one round if it was not corrected. None if nothing was simulated.
  std::optional<Polished> polished;
  /// For each target, an estimate of the relative error (root mean square) that the mesh makes in the first design's
  /// simulated response: FamilySimulation::error_share of its change on the coarser mesh. None if either simulation
  /// does not get to every sample, if the deadline passed, or if it was not asked for.
  std::vector<std::optional<double>> discretization_error;
};

/// Gives simulation the last word on a ranking of `find_designs`: the best designs of several spaces are ranked by
/// their simulated deviation, and the first of them is polished. A design that cannot be simulated at every sample
/// comes after those that can.
///
/// `simulations` has one entry for each space. If the deadline passes while polish is off, its error is thrown.
/// Otherwise the answer is the best design so far. Costs one simulation for each family and each round, and a coarser
/// one of the answer. Bills the effect "polish" and what the simulations bill.
VerifiedDesigns verify_designs(
    std::span<const DesignSpace> spaces, std::span<const FamilySimulation> simulations, const DesignProblem& problem,
    std::vector<Design> ranking, const DesignOptions& search, const VerificationPlan& plan,
    const Execution& execution = {},
    const std::function<void(const Design& design, const PolishRound& round)>& on_round = {});

/// A search, and how its result is verified.
struct DesignSearch {
  DesignProblem problem;
  DesignOptions options{};
  std::optional<VerificationPlan> verification{};  ///< if there is none, nothing is simulated
};

/// The functions to which a search reports on its way.
struct SearchObserver {
  OnProgress on_progress{};
  std::function<void(const Design& design, const PolishRound& round)> on_round{};
};

/// Searches and simulates the result: it calls `find_designs`, and then `verify_designs` if the search has a plan for
/// it. Without a plan `polished` and `discretization_error` are empty, `simulations` may be empty, and the bill says
/// so. The best design may have no structure, because tiles are too small or voids are closed in a corner of the
/// bounds; then its message says so.
VerifiedDesigns search_designs(std::span<const DesignSpace> spaces, std::span<const FamilySimulation> simulations,
                               const DesignSearch& search, const Execution& execution = {},
                               const SearchObserver& observer = {});

/// The space of a model with those of its parameters that can be built, and the simulation of its structures with the
/// material of the model's data.
DesignSpace design_space(const neural::Model& model, const neural::Evaluator& evaluator, const Candidates& candidates);
FamilySimulation simulation_of_model(const neural::Model& model);

}  // namespace supple::design
