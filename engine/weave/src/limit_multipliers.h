#pragma once

#include <vector>

#include "sliding_energies.h"

namespace supple::weave {

/// Rigid limits, as an augmented Lagrangian: E = sum over the closed limits of stiffness / 2 d^2 - force d, with
/// distances d (mm), multipliers `force` (N) and a stiffness far above that of the strands (Hestenes 1969; Powell 1969;
/// with a set of closed limits as in Nocedal and Wright 2006, sections 16.5 and 17.3). A minimum of the energy followed
/// by `update`, repeated, converges to sliders that stand at their limits exactly.
class LimitMultipliers : public Energy {
 public:
  /// Begins with every limit open. Both arguments outlive this.
  LimitMultipliers(const RodModel& model, const SlidingLimits& limits, const CrossingContact& contact);
  std::string_view name() const override { return "rigid_limits"; }

  /// Closes the limits whose barriers push at x, with the barriers' forces.
  void begin(const Eigen::VectorXd& x);
  /// At a minimum x: corrects the forces, opens limits that pull instead of pushing, and closes those that x has
  /// crossed. Returns whether a limit was opened or closed.
  bool update(const Eigen::VectorXd& x);
  bool all_open() const;
  /// The first-order error of the energy at x: the sum of |force d| over the closed limits, N mm.
  double error(const Eigen::VectorXd& x) const;
  /// E at x, N mm.
  double value(const Eigen::VectorXd& x) const;

  void add(const RodState& state, int order, numerics::EnergySum& sum) const override;
  /// No open limit is crossed by more than its barrier's range, so that no length of strand becomes negative.
  double largest_step(const RodState& state, const Eigen::VectorXd& step) const override;

 private:
  struct Limit {
    const BarrierEnergy* barriers = nullptr;
    const SlidingLimit* place = nullptr;
    double stiffness = 0;  ///< N/mm
    double force = 0;      ///< N
    bool closed = false;
  };
  std::vector<Limit> limits_;
};

}  // namespace supple::weave
