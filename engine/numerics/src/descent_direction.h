#pragma once

#include <Eigen/Core>
#include <deque>
#include <memory>

#include "supple/numerics/minimizer.h"

namespace supple::numerics {

/// Chooses where to go next. One per minimization; remembers what earlier steps showed of the curvature.
class DescentDirection {
 public:
  virtual ~DescentDirection() = default;
  /// The order of derivatives that `direction` reads where `keeps` does not say otherwise.
  virtual int order() const = 0;
  /// Whether the next direction needs no Hessian after a step that multiplied |g| by `contraction`.
  virtual bool keeps(double /*contraction*/) const { return false; }
  /// A direction d with g . d < 0 at the objective's current state, or an empty vector when there is none left to try.
  virtual Eigen::VectorXd direction(const Evaluation& at, Objective& objective) = 0;
  /// The line search found no step along the last direction: whether another one is worth a try.
  virtual bool retry() = 0;
  /// A step was accepted. `whole`: without backtracking. Vectors at the new state: the step and the old gradient, both
  /// transported, and the new gradient. `transport` carries remembered vectors to the new state.
  virtual void accepted(bool whole, const Eigen::VectorXd& step, const Eigen::VectorXd& old_gradient,
                        const Eigen::VectorXd& new_gradient) = 0;
  /// Carries what is remembered to the trial state, before `accepted`.
  virtual void transport(const Objective& /*objective*/) {}
  /// What was learned of the curvature no longer holds.
  virtual void forget() {}
  /// Added to the Hessian's diagonal for the last direction.
  virtual double regularization() const { return 0; }
  /// Whether the last direction came from another matrix than the Hessian: its length is then a guess.
  virtual bool is_rough() const { return regularization() > 0; }
  /// Whether a Hessian has been met that is not positive definite.
  virtual bool met_indefinite() const { return false; }
};

/// `factorization` may be null; see `minimize`.
std::unique_ptr<DescentDirection> make_descent_direction(const MinimizerOptions& options,
                                                         ShiftedCholesky* factorization,
                                                         const CancellationToken& cancellation);

}  // namespace supple::numerics
