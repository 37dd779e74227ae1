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
#include "supple/design/design_fault.h"
#include "supple/design/target.h"
#include "supple/numerics/bounded_least_squares.h"

namespace supple::design {

/// Measurements of a structure. Neither depends on the width of its beams in mm.
struct StructureMeasures {
  double relative_density = 0;  ///< solid area / cell area
  double cell_size = 0;         ///< square root of the cell's area, in beam widths
};
/// Measures the structure of parameters that can be built.
using MeasureStructure = std::function<StructureMeasures(const Eigen::VectorXd& parameters)>;

/// A model, its evaluator and its candidates. All of them must outlive the computation.
struct DesignSpace {
  const neural::Model& model;
  const neural::Evaluator& evaluator;
  const Candidates& candidates;
  Buildable buildable{};       ///< restricts searches to structures that can be built; any thread may call it
  MeasureStructure measure{};  ///< needed if a problem has limits; any thread may call it
};

struct Range {
  double least = 0;
  double most = std::numeric_limits<double>::infinity();
};

/// Limits on the measurements of a structure.
struct StructureLimits {
  Range relative_density{};
  Range cell_size{};  ///< square root of the cell's area, in beam widths
  /// Whether there is any limit.
  bool any() const;
};

/// The targets of one design, and what the search may change.
struct DesignProblem {
  std::vector<Target> targets;             ///< at least one; the first is the main target
  std::optional<Eigen::VectorXd> initial;  ///< starting point of the search, within the bounds
  /// The values of the fixed parameters, and none for the free ones. Either empty, or one entry for each parameter.
  std::vector<std::optional<double>> fixed;
  /// Amounts that are added to the model's values before they are compared with the targets: one entry for each sample
  /// of each target, or empty for none. The profiles of the answer do not include them.
  std::vector<Eigen::VectorXd> corrections{};
  /// Allowed ranges of Young's modulus in MPa, one for each material that the structure may be made of. Empty means the
  /// modulus of the model's data. Stresses are proportional to the modulus, and the design gets the modulus that fits
  /// the targets best. Each material is searched for by itself, one after the other, until one reaches the target. The
  /// design is then at least as good as the best of these searches, and the time is their sum. `corrections` are
  /// stresses at one modulus, and therefore need a single modulus.
  std::vector<Range> moduli{};
  /// Range of the angle by which the tiling may be turned counterclockwise, rad. The search finds the angle that fits
  /// the targets best. Responses have the period pi, so that a range of pi allows every orientation.
  Range orientation{0, 0};
  std::optional<double> initial_orientation{};  ///< orientation of `initial`, rad; without it the middle of the range
  StructureLimits limits{};
};

struct DesignOptions {
  /// The search ends once the next step is predicted to reduce the relative root mean square deviation by at most this.
  /// Increase it if a design is wanted quickly and an error of the model hides the difference.
  double tolerance = 1e-6;
  double equilibrium_tolerance = 1e-10;  ///< maximum of neural::uniaxial_residual
  /// Maximum number of iterations from one starting point. Increase it if a search stops at iteration_limit.
  int max_iterations = 200;
  /// Maximum number of starting points. 0 means 24 in one space, or 4 in each of several spaces. Increase it if a
  /// target is not reached that a structure of the family is known to reach; the time is proportional to it.
  int starts = 0;
  /// Number of designs from which starting points are chosen; 0 means default_candidates. Increase it with `starts` for
  /// families with many parameters.
  int candidates = 0;
  /// Whether there are further starting points. automatic uses them if there is no `initial`, or if the design found
  /// from `initial` does not reach the target or deviates by more than 0.1 %.
  Switch multi_start = Switch::automatic;
  /// Whether the model's error bars count in the comparison of designs. on, and automatic without `initial`, compare
  /// designs by sqrt(d^2 + u^2). Here d is the deviation by the model and u the uncertainty of the model
  /// (Design::uncertainty). If the design with the least d is uncertain, they also evaluate others. off compares
  /// designs by d alone.
  Switch trust = Switch::automatic;
  /// Whether the answer has the minimum and the maximum of the profile over all candidates. automatic gives them if the
  /// search has evaluated candidates.
  Switch envelope = Switch::automatic;
};

enum class DesignTermination {
  converged,           ///< no step reduces the deviation by more than the tolerance
  reached,             ///< the deviation is within the bands, or below 1e-9
  iteration_limit,     ///< max_iterations was reached
  step_too_small,      ///< steps became shorter than rounding, or have no equilibrium or structure at their end
  no_free_parameters,  ///< all parameters are fixed
  trusted,   ///< the search ended at a design with a smaller deviation; this one has a smaller sqrt(d^2 + u^2)
  deadline,  ///< the computation's deadline passed; the design is the best until then
  memory,    ///< a limit of memory was reached; the design is the best until then
};
std::string_view to_string(DesignTermination stop);
/// Whether a stop request ended the search before its end.
constexpr bool is_stopped(DesignTermination stop) {
  return stop == DesignTermination::deadline || stop == DesignTermination::memory;
}

struct DesignError {
  /// The weighted root mean square of the deviations beyond the bands, each divided by SampledTarget::scale, over all
  /// targets.
  double relative_rms = 0;
  /// Largest deviation from the main target beyond its band at a sample that has weight, in its unit.
  double max = 0;
};

/// A target and the profiles of designs at its samples. The vectors have one entry for each sample.
struct DesignProfile {
  SampledTarget target;
  Eigen::VectorXd initial;  ///< profile of the first starting point; NaN where it has no equilibrium
  Eigen::VectorXd achieved;
  /// Whether the model is trusted at each sample of the design found, as Profile::in_range.
  std::vector<std::uint8_t> in_range;
  Eigen::VectorXd error_bar;  ///< error bars of `achieved`, as Profile::error_bar
  /// Whether `achieved` is within the band, or within SampledTarget::tolerance beyond it.
  std::vector<std::uint8_t> reached;
  Eigen::VectorXd lowest;   ///< minimum over the candidates; empty if they were not evaluated
  Eigen::VectorXd highest;  ///< maximum over the candidates; empty if they were not evaluated
};

struct Design {
  std::size_t space = 0;  ///< index of the design space in which it was found
  Eigen::VectorXd parameters;
  double orientation = 0;     ///< rad; directions of the profiles are fixed in space and do not turn with the tiling
  std::size_t material = 0;   ///< index into DesignProblem::moduli
  double youngs_modulus = 0;  ///< MPa; the profiles are at this modulus
  std::vector<DesignProfile> profiles;  ///< one for each target
  DesignError error;
  /// Whether all samples of all targets that have weight are reached. The simulation decides if it reaches every
  /// sample. Otherwise the model decides.
  bool reached = false;
  int iterations = 0;  ///< total of all starting points
  int starts = 0;      ///< number of starting points that were used
  /// The number of strains at which the search evaluated the network. Evaluations for the candidates are not counted.
  std::int64_t evaluations = 0;
  DesignTermination stopped = DesignTermination::converged;
  std::string message;  ///< sentences for the user about the result; may be empty
  /// Sentences about parameters and the modulus at their limits, each after a space. `message` has them if the target
  /// is missed.
  std::string at_limits;
  double residual = 0;  ///< largest residual of the equilibria, as neural::uniaxial_residual
  /// Expected error of the samples at which the model is not trusted, relative to the targets' scales: the root mean
  /// square of their error bars / 1.645, with the weights of DesignError::relative_rms. A sample without an error bar
  /// counts as an error of 1. 0 if the model is trusted at every sample, or if DesignOptions::trust compares designs by
  /// their deviation alone.
  double uncertainty = 0;
  std::optional<double> model_error;  ///< neural::mean_stress_error of the design's model
  /// Measurements of the structure. Only the first design in the answer of `search_designs` has them, and only if its
  /// parameters give a structure.
  std::optional<StructureMeasures> measures{};
};

/// The best design so far, as `find_design` reports it.
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

/// No design that was tried can be built and has an equilibrium at every sample ("design.no_equilibrium").
class NoDesign : public DesignFault {
 public:
  using DesignFault::DesignFault;
};

/// Every design with such equilibria violates the limits ("design.beyond_limits").
class BeyondLimits : public NoDesign {
 public:
  using NoDesign::NoDesign;
};

/// Finds tiling parameters whose response follows the targets: the bi-level problems [Thesis, eqs. 4.9, 4.10 and 4.12],
/// several of them at once. The outer problem is solved by numerics::minimize_least_squares with the total derivatives
/// of all samples [Thesis, eqs. 4.14 to 4.18]. The inner problems are solved for all samples together, starting from
/// the equilibria of the previous design. The result is the best design of all starting points. Its profiles are
/// computed from rest, so that they do not depend on the path of the search.
///
/// Throws "design.invalid_target", "design.parameter_count", "design.parameter_out_of_bounds", "model.invalid_load",
/// "design.no_equilibrium" if no design that was tried can be built and has an equilibrium at every sample, and
/// "design.beyond_limits" if each design with these equilibria violates the limits. A target out of reach is no error.
/// A search that is stopped by its deadline or a limit of memory answers with its best design until then, says so in
/// `stopped` and the message, and takes the stop back (CancellationToken::resume). Without a design it throws
/// Cancelled. Bills the stages "candidates" and "optimization", the effects "multi_start", "envelope", "modulus",
/// "orientation", "limits" and, if the model has error bars, "trust", and the quantities "evaluations", "iterations"
/// and "restarts".
Design find_design(const DesignSpace& space, const DesignProblem& problem, const DesignOptions& options = {},
                   const Execution& execution = {}, const OnProgress& progress = {});

/// Finds the best design of each space and ranks the designs by the expected deviation of the real structure,
/// sqrt(d^2 + m^2). Here d is the design's relative root mean square deviation. m is the mean error of its model (1 if
/// unknown) or the design's uncertainty, whichever is larger. Problems with `initial` or `fixed` must have one space.
/// Spaces without any equilibrium are left out, and "design.no_equilibrium" is thrown if none remains. If the deadline
/// or a limit of memory stops the search in one of them, the first design says so, and spaces without a design until
/// then are left out, too.
std::vector<Design> find_designs(std::span<const DesignSpace> spaces, const DesignProblem& problem,
                                 const DesignOptions& options = {}, const Execution& execution = {},
                                 const OnProgress& progress = {});

}  // namespace supple::design
