#pragma once

#include <Eigen/Core>
#include <chrono>
#include <optional>
#include <vector>

#include "corrected_model.h"
#include "supple/design/polish.h"
#include "survey.h"

namespace supple::design {

/// Minimum predicted reduction of the deviation that is worth a simulation, as a fraction of the deviation, in (0, 1).
/// Reduce it if simulations are cheap.
inline constexpr double min_predicted_reduction = 0.02;

/// A simulated design. If its simulation failed, the values are empty and the deviation is infinite.
struct SimulatedDesign {
  Eigen::VectorXd x;          ///< free parameters, normalized to [0, 1] by their bounds
  Eigen::VectorXd simulated;  ///< values at all samples of all targets
  Eigen::VectorXd model;
  double deviation = infinite;
  Eigen::VectorXd correction() const { return simulated - model; }
};

/// The rounds of polishing: simulates one proposal after the other, keeps the best design, and says when a limit of the
/// options ends the polish. What is proposed next is decided elsewhere (TrustRegionDescent, OtherStarts,
/// SurveyedStarts). The arguments must outlive it.
class PolishRounds {
 public:
  PolishRounds(const DesignSpace& space, const DesignProblem& problem, const SimulateProfile& simulate,
               const PolishOptions& options, const Execution& execution, const OnPolishRound& on_round);

  /// Takes over the rounds of an earlier polish of the same problem.
  void resume(const Polished& before);

  /// Simulates the design that the network's search found, even if it violates the limits. It is the first round.
  SimulatedDesign simulate_found(const Eigen::VectorXd& parameters);
  /// Simulates the structure at the normalized parameters x.
  SimulatedDesign simulate(Proposal proposal, const Eigen::VectorXd& x);

  /// Why polishing has to end now; none if another round may begin.
  std::optional<PolishTermination> termination() const;
  /// The answer of a polish that ended for the given reason. There must be a round.
  Polished result(PolishTermination stopped) const;

  const DesignProblem& problem() const { return problem_; }  ///< the problem with the samples that are simulated
  const CorrectedModel& model() const { return model_; }
  const PolishOptions& options() const { return options_; }
  const CancellationToken& cancellation() const { return execution_.cancellation; }
  double seconds() const;  ///< time since polishing began
  int count() const { return static_cast<int>(rounds_.size()); }
  const SimulatedDesign& best() const { return best_; }
  /// All simulations that reached every sample.
  const std::vector<Survey::Observation>& observations() const { return observations_; }
  /// Normalized parameters of each round.
  const std::vector<Eigen::VectorXd>& tried() const { return tried_; }

 private:
  using Clock = std::chrono::steady_clock;

  SimulatedDesign simulate(Proposal proposal, const Eigen::VectorXd& x, const Eigen::VectorXd& parameters);
  void run_simulation(const Eigen::VectorXd& parameters, SimulatedDesign& trial, PolishRound& round);
  /// Records a round whose simulation was stopped.
  void record_stopped(PolishRound round, StopReason reason, Clock::time_point begin);
  void record(PolishRound round, Clock::time_point begin);

  const DesignProblem problem_;
  const SimulateProfile& simulate_;
  const PolishOptions& options_;
  const Execution& execution_;
  const OnPolishRound& on_round_;
  const CorrectedModel model_;
  const Clock::time_point start_;
  std::vector<PolishRound> rounds_;
  SimulatedDesign best_;
  std::vector<Survey::Observation> observations_;
  std::vector<Eigen::VectorXd> tried_;
  double longest_round_ = 0;  ///< s
};

}  // namespace supple::design
