#pragma once

#include <optional>
#include <span>
#include <vector>

#include "supple/design/polish.h"
#include "supple/design/verification.h"

namespace supple::design {

/// What is simulated of a ranking of designs.
struct VerificationPlan {
  /// off simulates the best design without changing it. automatic and on also correct it by simulations.
  Switch polish = Switch::automatic;
  PolishOptions options{};
  /// If there are several design spaces, this number of the best designs is simulated before the ranking is final.
  int families = 3;
};

/// A design, and its deviation in the simulation.
struct VerifiedDesign {
  Design design;
  /// Simulated deviation, as DesignError::relative_rms. None if the simulation did not reach every sample.
  std::optional<double> target_error;
};

struct VerifiedDesigns {
  /// Simulated designs come first, ordered by their simulated deviation before polishing.
  std::vector<VerifiedDesign> ranking;
  /// The polish of the first design. It has one round if the design was not corrected. None if nothing was simulated.
  std::optional<Polished> polished;
  /// For each target, an estimate of the relative error (root mean square) that the mesh causes in the first design's
  /// simulated response: FamilySimulation::error_ratio times the difference to the coarser mesh. None if either
  /// simulation does not reach every sample, if the deadline passed, or if no estimate is wanted.
  std::vector<std::optional<double>> discretization_error;
  /// How much each profile of the first design changes with its beam width; empty if that was not computed.
  std::vector<BeamWidthSensitivity> beam_width_sensitivity{};
};

/// Ranks the best designs of `find_designs` by their simulated deviation, and polishes the first of them. A design
/// whose simulation does not reach every sample comes after those whose simulation does. An empty ranking has an empty
/// answer and no bill.
///
/// `simulations` has one entry for each space. If the deadline passes or a limit of memory is reached, the answer is
/// the best design so far, which may be one that was not simulated (`is_simulated`). Costs one simulation for each
/// family and each round, and a coarser one of the answer. Bills the effect "polish" and what the simulations bill.
VerifiedDesigns verify_designs(
    std::span<const DesignSpace> spaces, std::span<const FamilySimulation> simulations, const DesignProblem& problem,
    std::vector<Design> ranking, const DesignOptions& search, const VerificationPlan& plan,
    const Execution& execution = {},
    const std::function<void(const Design& design, const PolishRound& round)>& on_round = {});

/// A search, and how its result is verified.
struct DesignSearch {
  DesignProblem problem;
  DesignOptions options{};
  std::optional<VerificationPlan> verification{};  ///< without it nothing is simulated
  /// Whether the answer says how sensitive the best design is to an error of its beam width. automatic does so if the
  /// design was simulated. It takes some tenths of a second.
  Switch beam_width_sensitivity = Switch::automatic;
};

/// Functions that a running search calls to report.
struct SearchObserver {
  OnProgress on_progress{};
  std::function<void(const Design& design, const PolishRound& round)> on_round{};
};

/// Calls `find_designs`, and then `verify_designs` if the search has a plan for it and was not stopped. Without a plan
/// `polished` and `discretization_error` are empty, `simulations` may be empty, and the bill has the effects
/// "verification" and "polish" as not run. It always has the effect "beam_width_sensitivity". The parameters of the
/// best design may have no structure, because tiles are too small or voids close in a corner of the bounds. Then its
/// message says so.
VerifiedDesigns search_designs(std::span<const DesignSpace> spaces, std::span<const FamilySimulation> simulations,
                               const DesignSearch& search, const Execution& execution = {},
                               const SearchObserver& observer = {});

/// The design space of a model, restricted to parameters that can be built, and the simulation of its structures with
/// the material of the model's data.
DesignSpace design_space(const neural::Model& model, const neural::Evaluator& evaluator, const Candidates& candidates);
FamilySimulation simulation_of_model(const neural::Model& model);

}  // namespace supple::design
