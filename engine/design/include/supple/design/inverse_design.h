#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>
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

/// What a structure measures, whatever the width of its beams.
struct StructureMeasures {
  double relative_density = 0;  ///< solid area / cell area
  double cell_size = 0;         ///< square root of the cell's area, in beam widths
};
/// Measures the structure of parameters that can be built.
using MeasureStructure = std::function<StructureMeasures(const Eigen::VectorXd& parameters)>;

/// A model and what belongs to it. All of them must outlive the computation.
struct DesignSpace {
  const neural::Model& model;
  const neural::Evaluator& evaluator;
  const Candidates& candidates;
  Buildable buildable{};       ///< searches keep to parameters that can be built; any thread may call it
  MeasureStructure measure{};  ///< needed by problems with limits; any thread may call it
};

struct Range {
  double least = 0;
  double most = std::numeric_limits<double>::infinity();
};

/// What a structure may measure.
struct StructureLimits {
  Range relative_density{};
  Range cell_size{};  ///< in beam widths
  /// Whether there is a limit at all.
  bool any() const;
};

/// What one design is to do.
struct DesignProblem {
  std::vector<Target> targets;             ///< at least one; the first is the main one
  std::optional<Eigen::VectorXd> initial;  ///< where to start, within the bounds
  /// The values of parameters that are held, and none for those that are to be found. Either empty, or one entry for
  /// each parameter.
  std::vector<std::optional<double>> fixed;
  /// What is added to the model's values before they are compared with the targets: one entry for each sample of each
  /// target, or empty for nothing. The profiles of the answer do not include it.
  std::vector<Eigen::VectorXd> corrections{};
  /// Young's moduli in MPa that the structure may have, one range for each material that it may be made of. The design
  /// has the modulus that serves the targets best, since stresses are proportional to it. Several materials are
  /// searched for one after the other, each as if it were the only one, until one reaches the target: the design is no
  /// worse than the best of these, and the search takes so many times as long. Empty means the modulus of the model's
  /// data. `corrections`, which are of that modulus, need a single modulus.
  std::vector<Range> moduli{};
  /// The angles by which the tiling may be turned counterclockwise, rad. The search finds the one that serves the
  /// targets best.
  /// Responses have the period pi, so that a range of pi leaves every orientation open.
  Range orientation{0, 0};
  std::optional<double> initial_orientation{};  ///< of `initial`; the middle of the range without it
  StructureLimits limits{};
};

struct DesignOptions {
  /// The search ends once a step promises to lessen the relative root mean square deviation by at most this.
  double tolerance = 1e-6;
  double equilibrium_tolerance = 1e-10;  ///< limit of neural::uniaxial_residual
  int max_iterations = 200;              ///< from one starting point
  /// How many starting points are followed at most. 0 means 24 in one space, or 4 in each of several spaces.
  int starts = 0;
  int candidates = 0;  ///< number of designs among which starting points are chosen; 0 means default_candidates
  /// Whether there are further starting points. automatic uses them if there is no `initial`, or if the design found
  /// from `initial` does not reach the target or deviates by more than 0.1 %.
  Switch multi_start = Switch::automatic;
  /// Whether designs are preferred of which the model can be trusted. on, and automatic without `initial`, compare
  /// designs by sqrt(d^2 + u^2), where d is the deviation by the model and u the doubt about it (Design::doubt), and
  /// look for others where the nearest is doubtful. off compares them by d alone.
  Switch trust = Switch::automatic;
  /// Whether the answer has the least and greatest values over the candidates. automatic gives them if candidates were
  /// evaluated anyway.
  Switch envelope = Switch::automatic;
};

enum class DesignStop {
  converged,           ///< no step lessens the deviation by more than the tolerance
  reached,             ///< within the bands, or below 1e-9
  iteration_limit,     ///< max_iterations
  step_too_small,      ///< steps became shorter than rounding, or led to places without equilibrium or structure
  no_free_parameters,  ///< all are fixed
  trusted,             ///< this design is trusted more than the nearer one at which the search ended
};
std::string_view to_string(DesignStop stop);

struct DesignError {
  /// The weighted root mean square, over all targets, of the deviations beyond the bands divided by
  /// SampledTarget::scale.
  double relative_rms = 0;
  double max = 0;  ///< largest deviation of the main target, in its unit
};

/// A target and the profiles of designs at its samples. The vectors have one entry for each sample.
struct DesignProfile {
  SampledTarget target;
  Eigen::VectorXd initial;  ///< profile of the first starting point; NaN where it has no equilibrium
  Eigen::VectorXd achieved;
  std::vector<std::uint8_t> in_range;  ///< whether the design that was found is in range
  Eigen::VectorXd error_bar;           ///< error bars of `achieved`, as Profile::error_bar
  std::vector<std::uint8_t> reached;   ///< within the band, or within 1 % of the target's scale beyond it
  Eigen::VectorXd lowest;              ///< least values over the candidates; empty if those were not evaluated
  Eigen::VectorXd highest;             ///< greatest values, likewise
};

struct Design {
  std::size_t space = 0;  ///< index of the design space in which it was found
  Eigen::VectorXd parameters;
  double orientation = 0;               ///< rad; the profiles are over directions of space
  std::size_t material = 0;             ///< index into DesignProblem::moduli
  double youngs_modulus = 0;            ///< MPa; the profiles are those of this modulus
  std::vector<DesignProfile> profiles;  ///< one for each target
  DesignError error;
  /// Whether all samples of all targets are reached. The simulation decides if one has got to all samples, and the
  /// model decides otherwise.
  bool reached = false;
  int iterations = 0;  ///< over all starting points
  int starts = 0;      ///< number of starting points that were followed
  /// The number of strains at which the search evaluated the network. Evaluations for the candidates are not counted.
  std::int64_t evaluations = 0;
  DesignStop stopped = DesignStop::converged;
  std::string message;  ///< what the user should know about the result; may be empty
  double residual = 0;  ///< the largest residual of the equilibria
  /// The error that is to be expected of those samples at which the model is not trusted: the root mean square of their
  /// error bars / 1.645, over the targets' scales, with the weights of DesignError::relative_rms; samples without an
  /// error bar count 1. 0 where the model is trusted everywhere, or where trust is not weighed.
  double doubt = 0;
  std::optional<double> model_error;  ///< neural::mean_stress_error
  /// What the structure measures. Only the first design in the answer of `search_designs` has it, and only if there is
  /// a structure.
  std::optional<StructureMeasures> measures{};
};

/// The best design so far.
struct DesignProgress {
  std::size_t space = 0;
  const Eigen::VectorXd& parameters;
  double orientation = 0;
  const ProfileSamples& samples;    ///< samples of the main target
  const Eigen::VectorXd& achieved;  ///< the design's profile at these samples
  DesignError error;
  int iteration = 0;
};
using OnProgress = std::function<void(const DesignProgress&)>;

/// Finds tiling parameters whose response follows the targets. These are the bi-level problems of thesis 4.9, 4.10 and
/// 4.12, several of them at once. The outer problem is solved by numerics::minimize_least_squares with the total
/// derivatives of all samples (4.14 to 4.18). The inner problems are solved for all samples together, starting from the
/// equilibria of the previous design. The result is the best design of all starting points. Its profiles are computed
/// from rest, so that they do not depend on the path of the search.
///
/// Throws "design.invalid_target", "design.parameter_count", "design.parameter_out_of_bounds", "model.invalid_load",
/// "design.no_equilibrium" if no design that was tried can be built and has an equilibrium at every sample, and
/// "design.beyond_limits" if every one of those is beyond the limits. A target out of reach is no error. Bills the
/// stages "candidates" and "optimization", the effects "multi_start", "envelope", "modulus", "orientation" and
/// "limits", and the quantities "evaluations", "iterations" and "restarts".
Design find_design(const DesignSpace& space, const DesignProblem& problem, const DesignOptions& options = {},
                   const Execution& execution = {}, const OnProgress& progress = {});

/// Finds the best design of each space and ranks them by the deviation that is to be expected of the structure. This is
/// sqrt(d^2 + m^2), where d is the relative root mean square deviation of the design and m the error of its model,
/// which is taken for 1 if it is unknown, or the doubt about the design where that is larger. Problems with `initial`
/// or `fixed` must have one space. Spaces without any equilibrium are left out, and "design.no_equilibrium" is thrown
/// if none remains.
std::vector<Design> find_designs(std::span<const DesignSpace> spaces, const DesignProblem& problem,
                                 const DesignOptions& options = {}, const Execution& execution = {},
                                 const OnProgress& progress = {});

}  // namespace supple::design
