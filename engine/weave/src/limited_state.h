#pragma once

#include <Eigen/Core>

#include "supple/base/execution.h"
#include "supple/numerics/cholesky.h"
#include "supple/weave/equilibrium.h"
#include "weave_system.h"

namespace supple::weave {

/// An equilibrium whose sliders stand at their limits, in the form in which it is reported.
struct LimitedState {
  Eigen::VectorXd q;         ///< all degrees of freedom
  Eigen::VectorXd gradient;  ///< derivatives of the energy by all degrees of freedom; those by fixed ones are reactions
  double energy = 0;         ///< N mm, without the potential of the forces
  double residual = 0;       ///< norm of the gradient by the free degrees of freedom, N
  bool stable = true;
  double limit_error = 0;  ///< estimated relative error of the energy because sliders do not stand at their limits
  int iterations = 0;
};

/// The current state of a system with barriers.
LimitedState with_barriers(WeaveSystem& system, double residual, bool stable);

/// Returns the equilibrium with rigid limits near `start`, which is an equilibrium with barriers. `rigid` is the same
/// system, in the same state, with rigid limits (WeaveSystem::with_rigid_limits). The result is `start` if no barrier
/// acts. It is also `start` if no equilibrium is found nearby, or only an unstable one near a stable `start`; its
/// limit_error is then the remaining error. Takes some Newton iterations if a slider is at its limit.
LimitedState with_rigid_limits(LimitedState start, WeaveSystem& rigid, numerics::ShiftedCholesky& cholesky,
                               const EquilibriumOptions& options, double gradient_tolerance,
                               const Execution& execution);

}  // namespace supple::weave
