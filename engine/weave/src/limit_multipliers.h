#pragma once

#include <vector>

#include "sliding_energies.h"

namespace supple::weave {

/// Rigid limits as an augmented Lagrangian: E = sum over the active limits of stiffness / 2 d^2 - force d, with
/// distances d (mm), Lagrange multipliers `force` (N) and a stiffness far above that of the strands [Hestenes1969],
/// [Powell1969]. The active set follows [Nocedal2006, sections 16.5 and 17.3]. Repeating a minimization of the energy
/// and `update` converges to sliders that stand exactly at their limits.
class LimitMultipliers : public Energy {
 public:
  /// Begins with every limit inactive. The arguments must outlive this object.
  LimitMultipliers(const RodModel& model, const SlidingLimits& limits, const CrossingContact& contact);
  std::string_view name() const override { return "rigid_limits"; }

  /// Activates the limits whose barriers push at x. The barriers' forces are the first multipliers.
  void initialize(const Eigen::VectorXd& x);
  /// Corrects the multipliers at a minimum x. Deactivates limits whose force has become tensile, and activates those
  /// that x has crossed. Returns whether the active set has changed.
  bool update(const Eigen::VectorXd& x);
  bool all_inactive() const;
  /// The first-order error of the energy at x: the sum of |force d| over the active limits, N mm.
  double error(const Eigen::VectorXd& x) const;
  /// The energy E at x, N mm.
  double value(const Eigen::VectorXd& x) const;

  void add(const RodState& state, int order, numerics::EnergySum& sum) const override;
  /// Largest step for which no limit is crossed by more than its barrier's range, so that no length of strand becomes
  /// negative.
  double largest_step(const RodState& state, const Eigen::VectorXd& step) const override;

 private:
  struct Limit {
    const BarrierEnergy* barriers = nullptr;
    const SlidingLimit* constraint = nullptr;
    double stiffness = 0;  ///< N/mm
    double force = 0;      ///< N
    bool active = false;
  };
  std::vector<Limit> limits_;
};

}  // namespace supple::weave
