#pragma once

#include <Eigen/Core>
#include <functional>
#include <string_view>

#include "supple/base/execution.h"

namespace supple::numerics {

/// The residuals r(x) of a least-squares problem in few unknowns. A function may store results between calls, for
/// example as initial guesses of inner problems.
class ResidualFunction {
 public:
  virtual ~ResidualFunction() = default;
  /// Computes the residuals at x, which lies within the bounds. Returns false if they do not exist there, e.g. because
  /// an inner problem has no solution. The solver then tries a shorter step.
  virtual bool residuals(const Eigen::VectorXd& x, Eigen::VectorXd& r) = 0;
  /// Computes dr/dx, with a column for each unknown. It is called only for the x of the last call of `residuals`, and
  /// only if the solver has accepted that point.
  virtual void jacobian(Eigen::MatrixXd& jacobian) = 0;
};

struct LeastSquaresOptions {
  /// Converged if the model predicts that |r| falls by at most this, for a step that the trust region does not shorten.
  double tolerance = 1e-6;
  /// The solver ends with `reached` once |r| <= this.
  double target = 1e-9;
  int max_iterations = 60;
  /// The radius of the trust region at the start: the fraction of the bounds' widths that a step may cover.
  double initial_radius = 0.25;
};

enum class LeastSquaresTermination {
  converged,        ///< no step within the bounds predicts a decrease beyond the tolerance
  reached,          ///< |r| <= target
  iteration_limit,  ///< max_iterations were made
  step_too_small,   ///< steps that decrease |r| became shorter than rounding, or r does not exist nearby
};
std::string_view to_string(LeastSquaresTermination stop);

struct LeastSquaresResult {
  Eigen::VectorXd x;
  double norm = 0;  ///< |r(x)|
  int iterations = 0;
  int evaluations = 0;  ///< number of evaluations of r
  LeastSquaresTermination stopped = LeastSquaresTermination::converged;
  bool defined = true;  ///< false if r does not exist at the start; then nothing was computed
};

/// Minimizes |r(x)|^2 / 2 over lower <= x <= upper by a trust-region method.
///
/// The models are Gauss-Newton models. The secant estimate of the residuals' second derivatives is added while it
/// predicts better [Dennis1981, NL2SOL]. This keeps the convergence fast for targets that cannot be reached, whose
/// residuals stay large. Each step minimizes the model, by an active-set method, over the intersection of the bounds
/// and the trust region (in the maximum norm, relative to the bounds' widths). In addition to the evaluations a step
/// takes O(n^3), where n is some tens at most.
///
/// `lower` < `upper` are finite, and x lies between them. `accepted`, if given, is called with each accepted point,
/// including the first one.
LeastSquaresResult minimize_least_squares(
    ResidualFunction& function, const Eigen::VectorXd& x, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
    const LeastSquaresOptions& options = {}, const Execution& execution = {},
    const std::function<void(const Eigen::VectorXd& x, double norm, int iteration)>& accepted = {});

/// Minimizes g^T s + s^T H s / 2 over lower <= s <= upper for a symmetric positive definite H. The bounds contain 0.
/// The active-set method ends at the exact minimizer. O(n^3) for each change of the active set.
Eigen::VectorXd minimize_quadratic_in_box(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& gradient,
                                          const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

}  // namespace supple::numerics
