#include "limited_state.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "supple/numerics/minimizer.h"
#include "weave_path.h"

namespace supple::weave {
namespace {

/// Maximum number of minimizations, each followed by an update of the multipliers and of the active set.
constexpr int max_corrections = 30;
/// Maximum number of Newton iterations of one such minimization. If the limits are near enough to be reached, it takes
/// about five.
constexpr int max_correction_iterations = 30;

double relative_to(double error, double energy) {
  return error == 0 ? 0 : error / std::max(std::abs(energy), std::numeric_limits<double>::min());
}

}  // namespace

LimitedState with_barriers(WeaveSystem& system, double residual, bool stable) {
  LimitedState state;
  state.q = system.q();
  state.gradient = system.full_gradient();
  state.energy = system.stored_energy();
  state.residual = residual;
  state.stable = stable;
  if (!system.limits()) return state;
  // Sliders that moved on to their limits would release the energy of the barriers, and the work of the barriers'
  // forces along the remaining distances.
  double error = 0;
  for (const BarrierEnergy* barriers :
       {static_cast<const BarrierEnergy*>(system.limits()), static_cast<const BarrierEnergy*>(system.contact())})
    for (const SlidingLimit& limit : barriers->limits())
      if (const Barrier b = barriers->at(limit, state.q); b.value > 0)
        error += b.value - b.first * limit.distance(state.q);
  state.limit_error = relative_to(error, state.energy);
  return state;
}

LimitedState with_rigid_limits(LimitedState start, WeaveSystem& rigid, numerics::ShiftedCholesky& cholesky,
                               const EquilibriumOptions& options, double gradient_tolerance,
                               const Execution& execution) {
  LimitMultipliers& limits = *rigid.multipliers();
  limits.initialize(rigid.q());
  rigid.forget();
  numerics::MinimizerOptions minimizer = minimizer_options();
  minimizer.gradient_tolerance = gradient_tolerance;
  minimizer.max_iterations = std::min(options.max_iterations, max_correction_iterations);
  int iterations = 0;
  for (int k = 0; k < max_corrections; ++k) {
    const numerics::MinimizerResult result =
        numerics::minimize(rigid, minimizer, {execution.cancellation, nullptr, nullptr}, &cholesky);
    iterations += result.iterations;
    if (result.stop != numerics::MinimizerTermination::converged) break;
    LimitedState state;
    state.q = rigid.q();
    state.gradient = rigid.full_gradient();
    state.residual = result.gradient_norm;
    state.energy = rigid.stored_energy();
    state.limit_error = relative_to(limits.error(state.q), state.energy);
    const bool active_set_changed = limits.update(state.q);
    rigid.forget();
    // If all limits became inactive, they were activated too early, and a cell that slides freely is now far from
    // equilibrium.
    if (active_set_changed && limits.all_inactive()) break;
    if (active_set_changed || state.limit_error > options.limit_tolerance) continue;
    state.stable = start.stable && (!result.indefinite || cholesky.factorize(rigid.evaluate(2).hessian, 0));
    if (start.stable && !state.stable) break;
    state.iterations = iterations;
    return state;
  }
  start.iterations = iterations;
  return start;
}

}  // namespace supple::weave
