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
  double barrier_range = 0.2;  ///< distance from a limit or a neighbouring crossing at which its barrier begins, mm
  /// Minimum length of strand between neighbouring crossings that slide, mm; by default Gap::contact_distance.
  std::optional<double> least_distance{};
  double sliding_regularization = 1e-6;  ///< N/mm
};

/// The energy of a weave: the terms that its model needs.
class WeaveSystem : public numerics::System<RodState> {
 public:
  /// `fixed` says for each degree of freedom whether its value is prescribed. `model` and the cost ledger of
  /// `execution`, to which every term is billed, must outlive the system. The chart is empty in the plane.
  WeaveSystem(const RodModel& model, Eigen::VectorXd q, Chart chart, const std::vector<bool>& fixed,
              const EnergyOptions& options, std::vector<PointForces::Load> forces = {},
              const Execution& execution = {});

  /// The same system in the same state, with rigid limits (see LimitMultipliers) instead of barriers before them. It
  /// shares all other terms with this system. The weave must have sliders.
  WeaveSystem with_rigid_limits() const;

  const RodModel& model() const { return *model_; }
  const Eigen::VectorXd& q() const { return state().q(); }
  const Chart& chart() const { return state().chart(); }
  /// Sets all degrees of freedom, fixed ones included, and rebases the chart. There must be no trial state.
  void set_state(Eigen::VectorXd q, Chart chart);
  /// Sets all degrees of freedom, which refer to the current chart.
  void set_q(Eigen::VectorXd q) { set_state(std::move(q), chart()); }
  /// Sets the fraction of their full size at which the forces act.
  void set_force_fraction(double fraction);
  /// The energy that is stored in the weave, in N mm, without the potential of forces and without the terms of rigid
  /// limits.
  double stored_energy();

  /// Null if nothing slides.
  const SlidingLimits* limits() const { return parts_.limits.get(); }
  const CrossingContact* contact() const { return parts_.contact.get(); }
  /// Null if limits have barriers, or if nothing slides.
  LimitMultipliers* multipliers() { return parts_.multipliers.get(); }

 private:
  /// All terms, and those to which other code needs access.
  struct Parts {
    Terms all;
    std::shared_ptr<SlidingLimits> limits;
    std::shared_ptr<CrossingContact> contact;
    std::shared_ptr<LimitMultipliers> multipliers;
    std::shared_ptr<PointForces> forces;
  };
  static Parts parts(const RodModel& model, const EnergyOptions& options, std::vector<PointForces::Load> forces);
  WeaveSystem(const RodModel& model, RodState state, const std::vector<bool>& fixed, Parts parts,
              const Execution& execution);

  const RodModel* model_;
  Parts parts_;
  std::vector<bool> fixed_;
  Execution execution_;
};

/// The degrees of freedom that are fixed in every weave, since nothing determines them: sliders that cannot move, the
/// spin of straight strands that nothing keeps from spinning, and, for a lattice, the first node's position.
std::vector<bool> gauge_constraints(const RodModel& model);

}  // namespace supple::weave
