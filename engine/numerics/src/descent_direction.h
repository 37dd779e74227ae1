#pragma once

#include <Eigen/Core>
#include <deque>
#include <memory>

#include "supple/numerics/minimizer.h"

namespace supple::numerics {

/// Computes descent directions for one minimization, and remembers the curvature that earlier steps have shown.
class DescentDirection {
 public:
  virtual ~DescentDirection() = default;
  /// The order of derivatives that `direction` reads, unless `reuses_factorization` says that it reads gradients only.
  virtual int order() const = 0;
  /// Whether the next direction needs no Hessian, after a step that multiplied |g| by `contraction`.
  virtual bool reuses_factorization(double /*contraction*/) const { return false; }
  /// A direction d with g . d < 0 at the objective's current state. It is empty if there is none left to try.
  virtual Eigen::VectorXd direction(const Evaluation& evaluation, Objective& objective) = 0;
  /// Called when the line search found no step along the last direction. Returns whether `direction` can give another
  /// one.
  virtual bool retry() = 0;
  /// Called when a step was accepted. `first_trial`: without backtracking. The vectors belong to the new state: the
  /// step and the old gradient, both transported, and the new gradient.
  virtual void accepted(bool first_trial, const Eigen::VectorXd& step, const Eigen::VectorXd& old_gradient,
                        const Eigen::VectorXd& new_gradient) = 0;
  /// Transports the remembered vectors to the trial state. Called before `accepted`.
  virtual void transport(const Objective& /*objective*/) {}
  /// Discards what was learned about the curvature, because it no longer holds.
  virtual void forget() {}
  /// What was added to the Hessian's diagonal for the last direction.
  virtual double regularization() const { return 0; }
  /// Whether the last direction was computed with another matrix than the Hessian. Its length is then a guess.
  virtual bool uses_modified_hessian() const { return regularization() > 0; }
  /// Whether a Hessian has been met that is not positive definite.
  virtual bool met_indefinite() const { return false; }
};

/// `factorization` may be null; see `minimize`.
std::unique_ptr<DescentDirection> make_descent_direction(const MinimizerOptions& options,
                                                         ShiftedCholesky* factorization,
                                                         const CancellationToken& cancellation);

}  // namespace supple::numerics
