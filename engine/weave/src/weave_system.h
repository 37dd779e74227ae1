#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "limit_multipliers.h"
#include "rod_energies.h"
#include "rod_state.h"
#include "sliding_energies.h"
#include "supple/base/cost_ledger.h"
#include "supple/numerics/system.h"

namespace supple::weave {

struct EnergyOptions {
  double barrier_range = 0.2;  ///< mm from a limit or a neighbour where its barrier begins
  /// Length of strand between neighbouring crossings that slide, mm. Without it, see Gap::touching.
  std::optional<double> least_distance{};
  double sliding_regularization = 1e-6;  ///< N/mm
};

/// A weave's energy: the terms that its model calls for.
class WeaveSystem : public numerics::System<RodState> {
 public:
  /// `held` says of each degree of freedom whether it is prescribed. `model` outlives the system; `cost`, if given,
  /// too: it is billed for every term. The chart is empty in the plane.
  WeaveSystem(const RodModel& model, Eigen::VectorXd q, Chart chart, const std::vector<bool>& held,
              const EnergyOptions& options, std::vector<PointForces::Load> forces = {},
              const Execution& execution = {});

  /// The same system in the same state, with rigid limits (see LimitMultipliers) instead of barriers before them. It
  /// shares all other terms with this system. Something must slide.
  WeaveSystem with_rigid_limits() const;

  const RodModel& model() const { return *model_; }
  const Eigen::VectorXd& q() const { return state().q(); }
  const Chart& chart() const { return state().chart(); }
  /// Sets held degrees of freedom (or any). Not while there is a trial state. The chart is rebased at once.
  void set_state(Eigen::VectorXd q, Chart chart);
  /// The same where the chart stays; q is seen from it.
  void set_q(Eigen::VectorXd q) { set_state(std::move(q), chart()); }
  void set_force_share(double share);
  /// The energy that the weave stores: without the potential of forces and without what rigid limits add. N mm.
  double stored_energy();

  /// Null where nothing slides.
  const SlidingLimits* limits() const { return parts_.limits.get(); }
  const CrossingContact* contact() const { return parts_.contact.get(); }
  /// Null where limits have barriers, or where nothing slides.
  LimitMultipliers* multipliers() { return parts_.multipliers.get(); }

 private:
  /// The terms, and those of them that others ask for.
  struct Parts {
    Terms all;
    std::shared_ptr<SlidingLimits> limits;
    std::shared_ptr<CrossingContact> contact;
    std::shared_ptr<LimitMultipliers> multipliers;
    std::shared_ptr<PointForces> forces;
  };
  static Parts parts(const RodModel& model, const EnergyOptions& options, std::vector<PointForces::Load> forces);
  WeaveSystem(const RodModel& model, RodState state, const std::vector<bool>& held, Parts parts,
              const Execution& execution);

  const RodModel* model_;
  Parts parts_;
  std::vector<bool> held_;
  Execution execution_;
};

/// Unknowns of a model: none held. Pinned sliders (no way to go), the spin of straight strands that nothing holds and,
/// for a lattice, the first node's position are held.
std::vector<bool> free_but_for_gauges(const RodModel& model);

}  // namespace supple::weave
