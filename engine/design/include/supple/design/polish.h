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

/// Parameters of a tiling and the angle by which it is turned, rad.
struct OrientedParameters {
  OrientedParameters(Eigen::VectorXd its_parameters, double its_orientation = 0)
      : parameters(std::move(its_parameters)), orientation(its_orientation) {}
  Eigen::VectorXd parameters;
  double orientation;
};

struct PolishOptions {
  /// Polishing ends once the simulated relative root mean square deviation is at most this.
  double tolerance = 2e-3;
  /// How many samples of each target are simulated at most. They are evenly spaced.
  int samples = 12;
  /// How many structures are simulated at most, in addition to the design that the search found.
  int max_rounds = 30;
  /// A round is not begun if it would end later than this, judging by the longest round so far.
  double max_seconds = 120;
  double equilibrium_tolerance = 1e-10;  ///< as in DesignOptions
};

enum class PolishStop {
  reached,         ///< the simulated deviation is at most the tolerance
  no_improvement,  ///< no proposal lessened the simulated deviation
  round_limit,     ///< max_rounds
  time_limit,      ///< max_seconds
  deadline,        ///< the computation's deadline passed, and the result is the best design so far
  not_simulated,   ///< no design that was tried has a structure whose simulation reaches every sample
};
std::string_view to_string(PolishStop stop);

/// Where parameters that were simulated came from.
enum class Proposal {
  search,      ///< the network's search
  step,        ///< a step of the corrected network within a trust region
  probe,       ///< a short move along a singular vector, to learn how the network's error changes
  new_search,  ///< another minimum of the corrected network
  survey       ///< a survey of the whole box, at the place where the network's error bar leaves most hope
};
std::string_view to_string(Proposal proposal);

/// One structure that was simulated.
struct PolishRound {
  Proposal proposal = Proposal::search;
  Eigen::VectorXd parameters;
  double orientation = 0;              ///< rad
  std::optional<double> target_error;  ///< simulated, as DesignError::relative_rms; none if the simulation failed
  bool accepted = false;
  std::string reason;  ///< why it was not accepted; empty if it was
  double seconds = 0;
};

struct Polished {
  Eigen::VectorXd parameters;              ///< parameters of the best design that was simulated
  double orientation = 0;                  ///< its orientation, rad
  std::vector<SampledTarget> targets;      ///< the targets at the samples that were simulated
  std::vector<Eigen::VectorXd> simulated;  ///< the best design's profile for each target; NaN if not reached
  std::vector<Eigen::VectorXd> model;      ///< the network's values at the same samples
  std::size_t material = 0;                ///< index into DesignProblem::moduli
  /// Of the material, in MPa: the one that serves the simulation best. `simulated` and `model` are of this modulus.
  double youngs_modulus = 0;
  double stress_factor = 1;            ///< youngs_modulus divided by that of the model's data
  std::optional<double> target_error;  ///< simulated deviation of the best design
  std::vector<PolishRound> rounds;     ///< the first is the design that the search found
  PolishStop stopped = PolishStop::reached;
};
using OnPolishRound = std::function<void(const PolishRound& round)>;

/// Simulates a design that the network's search has found, and corrects it by what the simulation says until the
/// *simulated* response is within the tolerance of the targets.
///
/// The network N is a cheap model of the simulation S, with the error c(x) = S(x) - N(x). Near the best design x_k so
/// far the simulation is approximated by N(x) + c(x_k) + A (x - x_k). The best parameters of this approximation within
/// a trust region are simulated next. A learns from every simulation by Broyden's rank-one update, so that for few
/// parameters the slope of the model becomes that of the simulation (manifold mapping, Echeverría and Hemker 2005).
/// Only a smaller simulated deviation is accepted. Otherwise the trust region shrinks, also if the parameters have no
/// structure or no path to every sample.
///
/// If steps fail twice or promise nothing, short moves along the singular vectors of the Jacobian determine A by
/// differences. If these do not help either, the best other minima of N(x) + c(x_k) are tried, each with a region of
/// its own. If the network's error exceeds the deviation of its minima, no minimum leads to the target. Then the whole
/// box is surveyed by N(x) + c(x), with c interpolated between all simulations, less what the network's error bars
/// leave open where nothing was simulated (a lower confidence bound, Cox and John 1992), until no place can be better.
///
/// If the problem leaves the modulus open, each simulation is compared with the targets by the modulus that serves it
/// best. A proposal beyond the problem's limits is refused without a simulation.
///
/// max_rounds = 0 only simulates the design. Each round costs a simulation of every target. The searches of the network
/// cost little compared with that. Bills what the simulations bill.
Polished polish(const DesignSpace& space, const DesignProblem& problem, const OrientedParameters& found,
                const SimulateProfile& simulate, const PolishOptions& options, const Execution& execution = {},
                const OnPolishRound& on_round = {});

/// Goes on where `before` ended. It must be of the same problem and of the same options, except for the limits. What it
/// simulated is not simulated again, and its rounds count.
Polished polish(const DesignSpace& space, const DesignProblem& problem, const Polished& before,
                const SimulateProfile& simulate, const PolishOptions& options, const Execution& execution = {},
                const OnPolishRound& on_round = {});

/// Describes the design at given parameters in the way in which `find_design` describes the one that it finds. It
/// serves for polished designs. The counts, the envelope and the first profile are those of `found`.
Design design_at(const DesignSpace& space, const DesignProblem& problem, const OrientedParameters& at,
                 const Design& found, const DesignOptions& options);

}  // namespace supple::design
