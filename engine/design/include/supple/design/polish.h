#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "supple/base/execution.h"
#include "supple/design/inverse_design.h"

namespace supple::design {

/// Parameters of a tiling, and the angle by which it is turned counterclockwise, rad.
struct OrientedParameters {
  OrientedParameters(Eigen::VectorXd its_parameters, double its_orientation = 0)
      : parameters(std::move(its_parameters)), orientation(its_orientation) {}
  Eigen::VectorXd parameters;
  double orientation;
};

struct PolishOptions {
  /// Polishing ends once the simulated relative root mean square deviation is at most this. Reduce it if the polished
  /// profile still visibly misses the target, but not below the noise of the simulations (about their mesh error).
  double tolerance = 2e-3;
  /// Maximum number of samples of each target that are simulated. They are evenly spaced. Increase it if the profile
  /// has features between the samples; the time of a round is proportional to it.
  int samples = 12;
  /// Maximum number of structures that are simulated, in addition to the design that the search found. Increase it if a
  /// polish stops at round_limit while its rounds still improve. With 0 the design is simulated and not improved.
  int max_rounds = 30;
  /// Maximum time of polishing, s. A round is not started if it would end later, judging by the longest round so far.
  /// Increase it if a polish stops at time_limit.
  double max_seconds = 120;
  double equilibrium_tolerance = 1e-10;  ///< as DesignOptions::equilibrium_tolerance
};

enum class PolishTermination {
  reached,         ///< the simulated deviation is at most the tolerance
  no_improvement,  ///< no proposal has a smaller simulated deviation
  round_limit,     ///< max_rounds was reached
  time_limit,      ///< the next round would exceed max_seconds
  deadline,        ///< the computation's deadline passed; the result is the best design so far
  memory,          ///< a limit of memory was reached; the result is the best design so far
  not_simulated,   ///< no design that was tried has a structure whose simulation reaches every sample
};
std::string_view to_string(PolishTermination stop);

/// Origin of the parameters of a simulated structure.
enum class Proposal {
  search,      ///< the network's search
  step,        ///< a step of the corrected network within a trust region
  probe,       ///< a short step along a singular vector of the Jacobian, to measure how the network's error changes
  new_search,  ///< another minimum of the deviation by the corrected network
  survey  ///< a design from anywhere within the bounds at which the lower confidence bound of the deviation is least
};
std::string_view to_string(Proposal proposal);

/// One simulated structure.
struct PolishRound {
  Proposal proposal = Proposal::search;
  Eigen::VectorXd parameters;
  double orientation = 0;  ///< rad
  /// Simulated deviation, as DesignError::relative_rms; none if the simulation failed.
  std::optional<double> target_error;
  bool accepted = false;
  std::string reason;  ///< why it was not accepted; empty if it was
  double seconds = 0;
};

struct Polished {
  Eigen::VectorXd parameters;          ///< parameters of the best simulated design
  double orientation = 0;              ///< orientation of the best simulated design, rad
  std::vector<SampledTarget> targets;  ///< the targets at the simulated samples
  /// The best design's profile for each target; NaN at samples that the simulation does not reach.
  std::vector<Eigen::VectorXd> simulated;
  std::vector<Eigen::VectorXd> model;  ///< the network's values at the same samples
  std::size_t material = 0;            ///< index into DesignProblem::moduli
  /// Young's modulus in MPa with which the simulation fits the targets best. `simulated` and `model` are at this
  /// modulus.
  double youngs_modulus = 0;
  double stress_factor = 1;            ///< youngs_modulus divided by the modulus of the model's data
  std::optional<double> target_error;  ///< simulated deviation of the best design
  std::vector<PolishRound> rounds;     ///< all simulated structures; the first is the design that the search found
  PolishTermination stopped = PolishTermination::reached;
};
/// Whether a stop request ended the polish before its end.
constexpr bool is_stopped(PolishTermination termination) {
  return termination == PolishTermination::deadline || termination == PolishTermination::memory;
}
/// Whether the simulation of any design ended. None did if the first one was stopped.
bool is_simulated(const Polished& polished);
using OnPolishRound = std::function<void(const PolishRound& round)>;

/// Simulates a design that the network's search has found, and corrects it until the *simulated* response is within the
/// tolerance of the targets.
///
/// The network N is a cheap model of the simulation S, with the error c(x) = S(x) - N(x). Near the best design x_k so
/// far the simulation is approximated by N(x) + c(x_k) + A (x - x_k). The design that minimizes the deviation of this
/// approximation within a trust region is simulated next. Each simulation updates A by Broyden's rank-one formula, so
/// that for few parameters the Jacobian of the approximation approaches that of the simulation (manifold mapping
/// [Echeverria2005]). A design is accepted only if its simulated deviation is smaller. Otherwise the trust region
/// shrinks. It also shrinks if the parameters have no structure or the simulation does not reach every sample.
///
/// If two steps in a row fail, or if no step is predicted to help, short steps ("probes") along the singular vectors of
/// the Jacobian determine A by finite differences. If these do not help either, polishing starts again, with a new
/// trust region, from the best other minima of the deviation of N(x) + c(x_k). If the network's error exceeds the
/// deviation of these minima, none of them leads to the target. Then the survey begins: N(x) + c(x) is evaluated
/// everywhere within the bounds, with c interpolated between all simulations. From its deviation a multiple of the
/// network's error bars is subtracted where nothing nearby was simulated (a lower confidence bound [Cox1992]). The
/// design with the least bound is simulated next, until no bound is below the best deviation.
///
/// If the problem has a range of moduli, each simulation is compared with the targets at the modulus that fits best. A
/// proposal beyond the problem's limits is refused without a simulation.
///
/// max_rounds = 0 only simulates the given design. Each round simulates every target. The network's searches cost
/// little compared with that. If the deadline passes or a limit of memory is reached, the answer is the best design so
/// far; the stop by the latter is taken back (CancellationToken::resume). Bills what the simulations bill.
Polished polish(const DesignSpace& space, const DesignProblem& problem, const OrientedParameters& found,
                const SimulateProfile& simulate, const PolishOptions& options, const Execution& execution = {},
                const OnPolishRound& on_round = {});

/// Continues where `before` ended. Problem and options must be the same, except for `max_rounds` and `max_seconds`. The
/// rounds of `before` count, and its designs are not simulated again.
Polished polish(const DesignSpace& space, const DesignProblem& problem, const Polished& before,
                const SimulateProfile& simulate, const PolishOptions& options, const Execution& execution = {},
                const OnPolishRound& on_round = {});

/// Describes the design at given parameters in the way in which `find_design` describes the one that it finds. It
/// serves for polished designs. The counts, the envelope and the profile of the first starting point are those of
/// `found`.
Design design_at(const DesignSpace& space, const DesignProblem& problem, const OrientedParameters& at,
                 const Design& found, const DesignOptions& options);

}  // namespace supple::design
