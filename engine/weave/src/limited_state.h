#pragma once

#include <Eigen/Core>

#include "supple/base/execution.h"
#include "supple/numerics/cholesky.h"
#include "supple/weave/equilibrium.h"
#include "weave_system.h"

namespace supple::weave {

/// An equilibrium whose sliders stand at their limits, as it is reported.
struct LimitedState {
  Eigen::VectorXd q;         ///< all degrees of freedom
  Eigen::VectorXd gradient;  ///< derivatives of the energy by all degrees of freedom; those by held ones are reactions
  double energy = 0;         ///< N mm, without the forces' potential
  double residual = 0;       ///< N
  bool stable = true;
  double limit_error = 0;  ///< estimated error of the energy because sliders do not stand at their limits, relative
  int iterations = 0;
};

/// The state of a system with barriers, as it is.
LimitedState with_barriers(WeaveSystem& system, double residual, bool stable);

/// Goes from an equilibrium with barriers, `start`, to that with rigid limits. `rigid` is the same system, in the same
/// state, with rigid limits (WeaveSystem::with_rigid_limits). Where no barrier pushes, this is `start`. Where none is
/// found nearby, or only an unstable one of a stable `start`, the result is `start` too, and its limit_error says how
/// much that matters. Takes some Newton iterations where a slider is at its limit.
LimitedState with_rigid_limits(LimitedState start, WeaveSystem& rigid, numerics::ShiftedCholesky& cholesky,
                               const EquilibriumOptions& options, double gradient_tolerance,
                               const Execution& execution);

}  // namespace supple::weave
