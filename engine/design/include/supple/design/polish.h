#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "supple/base/execution.h"
#include "supple/design/inverse_design.h"

namespace supple::design {

struct PolishOptions {
  /// Polishing ends once the simulated relative root mean square deviation is at most this.
  double tolerance = 2e-3;
  /// Samples of each target that are simulated, at most; evenly spaced.
  int samples = 12;
  /// Structures that are simulated, at most, beyond the design that the search found.
  int max_rounds = 30;
  /// A round that would end after so many seconds, by the longest one so far, is not begun.
  double max_seconds = 120;
  double equilibrium_tolerance = 1e-10;  ///< as in DesignOptions
};

enum class PolishStop {
  reached,         ///< the simulated deviation is at most the tolerance
  no_improvement,  ///< no proposal lessened the simulated deviation
  round_limit,     ///< max_rounds
  time_limit,      ///< max_seconds
  deadline,        ///< the computation's deadline passed: what stands is the best so far
  not_simulated,   ///< no design that was tried has a structure whose simulation reaches every sample
};
std::string_view to_string(PolishStop stop);

/// Where parameters that were simulated came from.
enum class Proposal {
  search,      ///< the network's search
  step,        ///< a step of the corrected network within a trust region
  probe,       ///< a short move along a singular vector, to learn how the network's error changes
  new_search,  ///< another minimum of the corrected network
  survey       ///< of places all over the box, where the network's error bar leaves the most open
};
std::string_view to_string(Proposal proposal);

/// One structure that was simulated.
struct PolishRound {
  Proposal proposal = Proposal::search;
  Eigen::VectorXd parameters;
  std::optional<double> target_error;  ///< simulated, as DesignError::relative_rms; none where simulation failed
  bool accepted = false;
  std::string reason;  ///< why it was not accepted; empty if it was
  double seconds = 0;
};

struct Polished {
  Eigen::VectorXd parameters;              ///< of the best design that was simulated
  std::vector<SampledTarget> targets;      ///< at the samples that were simulated
  std::vector<Eigen::VectorXd> simulated;  ///< of the best design, for each target; NaN where simulation did not get
  std::vector<Eigen::VectorXd> model;      ///< the network's values there
  std::optional<double> target_error;      ///< simulated, of the best design
  std::vector<PolishRound> rounds;         ///< the first is the design that the search found
  PolishStop stopped = PolishStop::reached;
};
using OnPolishRound = std::function<void(const PolishRound& round)>;

/// Simulates a design that the network's search has found, and corrects it by what the simulation says until the
/// *simulated* response is within the tolerance of the targets.
///
/// The network is a cheap model of the simulation that is off by c(x) = S(x) - N(x). Near the best design x_k so far
/// it is taken for N(x) + c(x_k) + A (x - x_k), whose best parameters within a trust region are simulated next; A
/// learns from every simulation by Broyden's rank-one update, so that for few parameters the model's slope becomes the
/// simulation's (manifold mapping, Echeverría and Hemker 2005). Only a simulated deviation that is less is accepted;
/// the trust region shrinks otherwise, also where parameters have no structure or no path to every sample. Where steps
/// fail twice or promise nothing, short moves along the singular vectors of the Jacobian give A by differences; where
/// these do not help either, the best other minima of N(x) + c(x_k) are tried, each with a region of its own. Where the
/// network is off by more than its minima deviate, no minimum leads to the target: then places all over the box are
/// surveyed, by N(x) + c(x) with c interpolated between all simulations, less what the network's error bars leave open
/// where nothing was simulated (a lower confidence bound, Cox and John 1992), until none may be better.
///
/// max_rounds = 0 simulates the design alone. Costs a simulation of every target a round; the searches of the network
/// are little beside that. Bills what the simulations bill.
Polished polish(const DesignSpace& space, const DesignProblem& problem, const Eigen::VectorXd& parameters,
                const SimulateProfile& simulate, const PolishOptions& options, const Execution& execution = {},
                const OnPolishRound& on_round = {});

/// Goes on where `before`, of the same problem and options but for its limits, ended: what it simulated is not
/// simulated again, and its rounds count.
Polished polish(const DesignSpace& space, const DesignProblem& problem, const Polished& before,
                const SimulateProfile& simulate, const PolishOptions& options, const Execution& execution = {},
                const OnPolishRound& on_round = {});

/// The design at given parameters, as `find_design` tells of the one that it finds: for a polished one. It keeps the
/// counts, the envelope and the first profile of `found`.
Design design_at(const DesignSpace& space, const DesignProblem& problem, const Eigen::VectorXd& parameters,
                 const Design& found, const DesignOptions& options);

}  // namespace supple::design
