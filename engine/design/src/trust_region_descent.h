#pragma once

#include <Eigen/Core>
#include <optional>

#include "polish_rounds.h"

namespace supple::design {

/// A descent from one simulated design by manifold mapping [Echeverria2005]. Near its best design x_k the simulation is
/// approximated by N(x) + c(x_k) + A (x - x_k), where N is the network, c the correction and A the slope of the
/// correction. Steps minimize the deviation of this approximation within a trust region. Each simulation updates A, and
/// probes measure it where steps fail.
class TrustRegionDescent {
 public:
  /// `rounds` must outlive the descent. `from` has a finite deviation.
  TrustRegionDescent(PolishRounds& rounds, SimulatedDesign from);

  /// Improves the design. Returns the limit that ends the whole polish; none if only this descent ends.
  std::optional<PolishTermination> run();

 private:
  void begin_allotment();
  bool is_allotment_spent() const;
  CorrectedModel::Step best_step() const;
  bool is_promising(const CorrectedModel::Step& step) const;
  void try_step(const CorrectedModel::Step& step);
  std::optional<PolishTermination> probe(const Eigen::VectorXd& preferred_direction);
  void update_slope(const SimulatedDesign& trial);
  /// The correction around the best design, in normalized parameters.
  Correction correction() const { return {best_.correction(), slope_, best_.x}; }

  PolishRounds& rounds_;
  const CorrectedModel& model_;
  SimulatedDesign best_;
  Eigen::MatrixXd slope_;  ///< A, the derivative of the correction by normalized parameters
  double radius_;
  int rejected_ = 0;                       ///< consecutive rejected steps
  bool probed_ = false;                    ///< whether probes were made around the best design
  double deviation_at_probes_ = infinite;  ///< deviation of the best design at the last probes
  int allotment_begin_ = 0;                ///< number of all rounds when the present allotment began
  double deviation_at_allotment_ = infinite;
};

}  // namespace supple::design
