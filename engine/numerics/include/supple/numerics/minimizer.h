#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "supple/base/execution.h"
#include "supple/numerics/cholesky.h"
#include "supple/numerics/objective.h"

namespace supple::numerics {

enum class MinimizerMethod { newton, lbfgs, gradient_descent };

struct MinimizerStep {
  double value = 0;
  double gradient_norm = 0;
  double step_length = 0;     ///< length of the step that led to this state; 0 for the start
  double regularization = 0;  ///< lambda of that step, in the unit of the Hessian
};

/// Options of a minimization. Every tolerance is written as the inequality that is tested. f is the value, g the
/// gradient, d the direction, s the step, and f(t), g(t) are those after the step t d.
struct MinimizerOptions {
  MinimizerMethod method = MinimizerMethod::newton;
  /// Converged once |g| <= gradient_tolerance (Euclidean norm; the unit of f per unit of length).
  double gradient_tolerance = 1e-9;
  /// A trial with |s| <= step_tolerance is not made. A line search that would have to make one has failed (unit of
  /// length).
  double step_tolerance = 1e-300;
  int max_iterations = 200;
  /// A trial at the fraction t of d is accepted once f(t) <= f + armijo * t * (g . d) ...
  double armijo = 1e-4;
  /// ... unless t * |g . d| <= value_rounding * max(|f|, |f(t)|), where rounding hides the decrease. Such a trial is
  /// accepted once f(t) <= f + value_rounding * max(|f|, |f(t)|) and |g(t)| <= (1 - gradient_decrease) * |g|. The
  /// default is relative and suits sums of up to some thousand terms: a few dozen units in the last place of a double.
  double value_rounding = 1e-14;
  double gradient_decrease = 1e-3;
  /// After a rejected trial, t is shortened to the minimum of the parabola through f, g . d and f(t), within
  /// [min_backtrack_factor, max_backtrack_factor] * t.
  double min_backtrack_factor = 0.1;
  double max_backtrack_factor = 0.5;
  int max_backtracks = 50;

  /// Newton: (H + lambda I) d = -g with lambda = regularization * matrix_scale(H). The regularization starts at 0. It
  /// is multiplied by `raise`, from `first_regularization` on, if the factorization fails or no step is found. It is
  /// multiplied by `lower` after a step without backtracking, and is 0 again below `first_regularization`. Above
  /// `max_regularization` the search for a step ends.
  double first_regularization = 1e-6;
  double raise = 10;
  double lower = 0.1;
  double max_regularization = 1e10;
  /// Newton: if the Hessian is not positive definite, a regularized step has a good direction and a bad length. A step
  /// that is accepted at t = 1 is doubled while the value falls, up to this multiple of d. 1 means never.
  double max_expansion = 1;
  /// Newton: if a step multiplied |g| by at most this, the next direction uses the same factorization again, so that
  /// only gradients are evaluated [Shamanskii1967]. 0 means a factorization in every iteration.
  double reuse_contraction = 0;

  /// A step creeps if it lowers the value by less than this fraction of a predicted decrease. The prediction is |g .
  /// d|. After a creeping step it is at least half of that step's prediction. A single creeping step is usual at a kink
  /// of the value. Many in succession mean that the steps zigzag across one. 0 means that no step creeps.
  double stagnation_fraction = 0;
  /// After this many creeping steps in succession, each further one raises the regularization (Newton) or discards the
  /// measured curvature (other methods). After max_stagnant_steps in succession the search ends with step_too_small.
  int stagnant_steps_without_regularization = 5;
  int max_stagnant_steps = 30;

  /// Newton: the search ends with `saddle` if |g| falls to this fraction while the regularization of no step is less
  /// than half of that of the step before. The search is then on its way to a saddle, which a step along the direction
  /// of negative curvature leaves sooner. 0 means never.
  double saddle_contraction = 0;
  int lbfgs_history = 10;
  /// L-BFGS: a step is long enough once the slope along it has risen to this multiple of the slope at its start, which
  /// is the weak Wolfe condition [Lewis2013]. It lies in (armijo, 1); 0 means that the condition is not used. Every
  /// trial that lowers the value then needs a gradient. With the condition, every pair shows positive curvature, so
  /// that L-BFGS proceeds along kinks of the value, where it would otherwise end.
  double slope_contraction = 0;
  /// L-BFGS and gradient descent: the first direction is -first_step * g. The length of later directions comes from the
  /// measured curvature.
  double first_step = 1;
  /// Called at the start and after every iteration, when the objective's current state is the one to which the step
  /// led.
  std::function<void(const MinimizerStep&)> after_step{};
};

enum class MinimizerTermination {
  converged,
  step_too_small,  ///< no trial was accepted, or too many steps in succession crept
  saddle,          ///< see MinimizerOptions::saddle_contraction
  iteration_limit
};
std::string_view to_string(MinimizerTermination stop);

struct MinimizerResult {
  MinimizerTermination stop = MinimizerTermination::iteration_limit;
  int iterations = 0;
  double value = 0;
  double gradient_norm = 0;
  std::vector<MinimizerStep> history;  ///< the start and one entry for every iteration
  /// Newton: index into `history` of the state whose Hessian was factorized last; -1 if none was.
  int factorized_at = -1;
  bool indefinite = false;  ///< Newton: whether a Hessian on the way was not positive definite
};

/// Minimizes from the objective's current state. When it returns, the current state is the best one that was found:
/// values never rise by more than their rounding. Each iteration takes one gradient or Hessian and one or more values.
///
/// `newton` is a regularized Newton method with one or more Cholesky factorizations per iteration. `lbfgs` is the
/// two-loop recursion [Nocedal2006, algorithm 7.4], whose pairs are transported along the steps. `gradient_descent`
/// uses the step lengths of [Barzilai1988], made monotone by the same line search.
///
/// Bills the stage "step" (factorization and direction). Its progress is the decrease so far of log |g|, as a fraction
/// of the decrease down to the tolerance. It checks for a stop request before every evaluation. Throws Error
/// "minimizer.not_finite" if the value or the gradient at the start is not finite.
///
/// `factorization`, if given, computes Newton's directions. It keeps its symbolic analysis from one call to the next,
/// and the caller finds the last factorization in it (see MinimizerResult::factorized_at).
MinimizerResult minimize(Objective& objective, const MinimizerOptions& options = {}, const Execution& execution = {},
                         ShiftedCholesky* factorization = nullptr);

}  // namespace supple::numerics
