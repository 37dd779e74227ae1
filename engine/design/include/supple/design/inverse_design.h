#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "supple/base/effect_switch.h"
#include "supple/base/execution.h"
#include "supple/design/candidates.h"
#include "supple/design/target.h"
#include "supple/numerics/bounded_least_squares.h"

namespace supple::design {

/// A model and what belongs to it; all outlive the computation.
struct DesignSpace {
  const neural::Model& model;
  const neural::Evaluator& evaluator;
  const Candidates& candidates;
  Buildable buildable{};  ///< searches keep to parameters that are; any thread may call it
};

/// What one design is to do.
struct DesignProblem {
  std::vector<Target> targets;             ///< at least one; the first is the main one
  std::optional<Eigen::VectorXd> initial;  ///< where to start, within the bounds
  /// Values of parameters that are held, none for those to be found; empty, or one entry for each parameter.
  std::vector<std::optional<double>> fixed;
  /// What is added to the model's values before they are compared, an entry for each sample of each target; empty:
  /// nothing. Profiles are told without it.
  std::vector<Eigen::VectorXd> corrections{};
};

struct DesignOptions {
  /// The search ends once a step promises to lessen the relative root mean square deviation by at most this.
  double tolerance = 1e-6;
  double equilibrium_tolerance = 1e-10;  ///< of neural::uniaxial_residual
  int max_iterations = 200;              ///< from one starting point
  /// Starting points that are followed at most. 0: 24 in one space, 4 in each of several.
  int starts = 0;
  int candidates = 0;  ///< designs from which they are chosen; 0: default_candidates
  /// Further starting points. automatic: where the design found from `initial` does not reach the target or deviates by
  /// more than 0.1 %, and without `initial`.
  Switch multi_start = Switch::automatic;
  /// Least and greatest values over the candidates. automatic: where candidates were evaluated anyway.
  Switch envelope = Switch::automatic;
};

enum class DesignStop {
  converged,           ///< no step lessens the deviation by more than the tolerance
  reached,             ///< within the bands, or below 1e-9
  iteration_limit,     ///< max_iterations
  step_too_small,      ///< steps became shorter than rounding, or led where there is no equilibrium or no structure
  no_free_parameters,  ///< all are fixed
};
std::string_view to_string(DesignStop stop);

struct DesignError {
  /// Weighted root mean square of the deviations beyond the bands, over SampledTarget::scale; over all targets.
  double relative_rms = 0;
  double max = 0;  ///< largest deviation of the main target, in its unit
};

/// A target and what designs do, an entry for each sample.
struct DesignProfile {
  SampledTarget target;
  Eigen::VectorXd initial;  ///< at the first starting point; NaN where it has no equilibrium
  Eigen::VectorXd achieved;
  std::vector<std::uint8_t> in_range;  ///< of the design found
  Eigen::VectorXd error_bar;           ///< of `achieved`, as Profile::error_bar
  std::vector<std::uint8_t> reached;   ///< within the band, or within 1 % of the target's scale beyond it
  Eigen::VectorXd lowest;              ///< over the candidates; empty where they were not evaluated
  Eigen::VectorXd highest;
};

struct Design {
  std::size_t space = 0;  ///< index of its design space
  Eigen::VectorXd parameters;
  std::vector<DesignProfile> profiles;  ///< one for each target
  DesignError error;
  /// All samples of all targets: by the simulation where one has got to all of them, by the model otherwise.
  bool reached = false;
  int iterations = 0;  ///< over all starting points
  int starts = 0;      ///< that were followed
  /// Strains at which the network was evaluated for the search, those of the candidates not counted.
  std::int64_t evaluations = 0;
  DesignStop stopped = DesignStop::converged;
  std::string message;                ///< what to know about the result; empty where there is nothing
  double residual = 0;                ///< largest of the equilibria
  std::optional<double> model_error;  ///< neural::mean_stress_error
};

/// The best design so far.
struct DesignProgress {
  std::size_t space = 0;
  const Eigen::VectorXd& parameters;
  const ProfileSamples& samples;    ///< of the main target
  const Eigen::VectorXd& achieved;  ///< there
  DesignError error;
  int iteration = 0;
};
using OnProgress = std::function<void(const DesignProgress&)>;

/// Tiling parameters whose response follows the targets: the bi-level problems of thesis 4.9, 4.10 and 4.12, several
/// at once. The outer problem is solved by numerics::minimize_least_squares with the total derivatives of all samples
/// (4.14 to 4.18), the inner ones for all samples together, warm started. The design that is returned is the best of
/// all starting points; its profiles are worked out from rest, so that they do not depend on the way there.
///
/// Throws "design.invalid_target", "design.parameter_count", "design.parameter_out_of_bounds", "model.invalid_load",
/// and "design.no_equilibrium" where no design that was tried can be built and has an equilibrium at every sample. A
/// target out of reach is no error. Bills the stages "candidates" and "optimization", the effects "multi_start" and
/// "envelope", and the quantities "evaluations", "iterations" and "restarts".
Design find_design(const DesignSpace& space, const DesignProblem& problem, const DesignOptions& options = {},
                   const Execution& execution = {}, const OnProgress& progress = {});

/// The best design of each space, best first by what is to be expected of the structure: the root of the squares of its
/// relative root mean square deviation and of the model's error, which is 1 where it is unknown. Problems with
/// `initial` or `fixed` have one space. Spaces without any equilibrium are left out; "design.no_equilibrium" is thrown
/// where none remains.
std::vector<Design> find_designs(std::span<const DesignSpace> spaces, const DesignProblem& problem,
                                 const DesignOptions& options = {}, const Execution& execution = {},
                                 const OnProgress& progress = {});

}  // namespace supple::design
