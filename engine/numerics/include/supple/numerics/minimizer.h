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

/// Every tolerance is written as the inequality that is tested. f is the value, g the gradient, d the direction, s the
/// step.
struct MinimizerOptions {
  MinimizerMethod method = MinimizerMethod::newton;
  /// Converged once |g| <= gradient_tolerance (Euclidean norm; the unit of f per unit of length).
  double gradient_tolerance = 1e-9;
  /// A trial with |s| <= step_tolerance is not made. A line search that arrives at it has failed (unit of length).
  double step_tolerance = 1e-300;
  int max_iterations = 200;
  /// A trial of share t is accepted once f(t) <= f + armijo * t * (g . d) ...
  double armijo = 1e-4;
  /// ... unless t * |g . d| <= value_rounding * max(|f|, |f(t)|): f cannot show so small a decrease. Such a trial is
  /// accepted once f(t) <= f + value_rounding * max(|f|, |f(t)|) and |g(t)| <= (1 - gradient_decrease) * |g|. Relative;
  /// for sums of up to some thousand terms a few dozen units in the last place of a double.
  double value_rounding = 1e-14;
  double gradient_decrease = 1e-3;
  /// After a rejected trial t is shortened to the minimum of the parabola through f, g . d and f(t), within [shortest,
  /// longest] * t.
  double shortest_backtrack = 0.1;
  double longest_backtrack = 0.5;
  int max_backtracks = 50;

  /// Newton: (H + lambda I) d = -g with lambda = regularization * matrix_scale(H). It starts at 0, grows by `raise`
  /// from `first_regularization` where the factorization fails or no step is found, falls by `lower` after a whole
  /// step, and is 0 again below `first_regularization`. Above `max_regularization` the search for a step ends.
  double first_regularization = 1e-6;
  double raise = 10;
  double lower = 0.1;
  double max_regularization = 1e10;
  /// Newton: if the Hessian is not positive definite, a regularized step has a good direction and a bad length. A step
  /// that is accepted completely is doubled while the value falls, up to this multiple. 1 means never.
  double longest_expansion = 1;
  /// Newton: if a step brought |g| to this share or less, the next direction uses the same factorization again
  /// (Shamanskii 1967), so that only gradients are evaluated. 0 means a factorization in every iteration.
  double reuse_contraction = 0;

  /// A step creeps if it lowers the value by less than this share of what the slope at its start promises, |g . d|, or
  /// of half of what counted at the step before if that crept too. One such step is the price of a kink; many in
  /// succession go to and fro across one. 0 means that no step creeps.
  double creeping_share = 0;
  /// After so many steps in succession that creep, each further one is regularized more than the one before (Newton),
  /// and after so many the search ends with step_too_small.
  int creeping_steps_without_regularization = 5;
  int max_creeping_steps = 30;

  /// Newton: if |g| falls to this share while no step needs less regularization than the one before, the search is on
  /// its way to a saddle. A step along the direction of negative curvature leaves the saddle sooner, so the search
  /// stops. 0 means never.
  double saddle_contraction = 0;
  int lbfgs_history = 10;
  /// L-BFGS: a step is long enough once the slope along it has risen to this share of the slope at its start (the weak
  /// Wolfe condition); in (armijo, 1), or 0 not to ask for it. Every trial step that lowers the value then needs a
  /// gradient. With it, pairs always show curvature, so that L-BFGS goes on across kinks of the value, along which it
  /// would otherwise stop (Lewis and Overton 2013).
  double slope_contraction = 0;
  /// L-BFGS, gradient descent: the first direction is -first_step * g. Later directions get their length from the
  /// measured curvature.
  double first_step = 1;
  /// Called with the start and after every iteration, when the objective's current state is the one to which the step
  /// led.
  std::function<void(const MinimizerStep&)> after_step{};
};

enum class MinimizerStop {
  converged,
  step_too_small,  ///< no trial was accepted in any direction that was tried
  saddle,          ///< see MinimizerOptions::saddle_contraction
  iteration_limit
};
std::string_view to_string(MinimizerStop stop);

struct MinimizerResult {
  MinimizerStop stop = MinimizerStop::iteration_limit;
  int iterations = 0;
  double value = 0;
  double gradient_norm = 0;
  std::vector<MinimizerStep> history;  ///< the start and every iteration
  /// Newton: index into `history` of the state whose Hessian was factorized last; -1 if none was.
  int factorized_at = -1;
  bool indefinite = false;  ///< Newton: whether a Hessian on the way was not positive definite
};

/// Minimizes from the objective's current state. When it returns, the current state is the best one that was found:
/// values never rise by more than their rounding. Each iteration takes one gradient or Hessian and one or more values.
///
/// newton is a regularized Newton method with one or more Cholesky factorizations per iteration. lbfgs is the two-loop
/// recursion (Nocedal and Wright 2006, algorithm 7.4) with the pairs transported along the steps. gradient_descent uses
/// the step lengths of Barzilai and Borwein (1988), made monotone by the same line search.
///
/// Bills the stage "step" (factorization and direction), reports progress as the share of the logarithm of the gradient
/// norm, and looks for a stop request before every evaluation. Throws Error "minimizer.not_finite" where the start has
/// no finite value and gradient.
///
/// `factorization`, if given, is used for Newton's directions: it keeps its symbolic analysis from one call to the
/// next, and the caller finds the last factorization in it (see MinimizerResult::factorized_at).
MinimizerResult minimize(Objective& objective, const MinimizerOptions& options = {}, const Execution& execution = {},
                         ShiftedCholesky* factorization = nullptr);

}  // namespace supple::numerics
