#pragma once

#include <Eigen/Core>
#include <functional>
#include <string_view>

#include "supple/base/execution.h"

namespace supple::numerics {

/// Residuals r(x) of a least-squares problem in few unknowns. It may keep what it has worked out between calls, e.g. to
/// start inner problems from.
class ResidualFunction {
 public:
  virtual ~ResidualFunction() = default;
  /// Residuals at x, which lies within the bounds. False where they do not exist there (an inner problem that has no
  /// solution): the solver then tries a shorter step.
  virtual bool residuals(const Eigen::VectorXd& x, Eigen::VectorXd& r) = 0;
  /// dr/dx, a column for each unknown. Asked for only at the x of the last call of `residuals`, and only where the
  /// solver has accepted that point.
  virtual void jacobian(Eigen::MatrixXd& jacobian) = 0;
};

struct LeastSquaresOptions {
  /// Converged once the model promises |r| to fall by at most this, by a step that the trust region does not shorten.
  double tolerance = 1e-6;
  /// Reached once |r| <= this.
  double target = 1e-9;
  int max_iterations = 60;
  /// Of the trust region at the start: share of each bound's width that a step may cover.
  double initial_radius = 0.25;
};

enum class LeastSquaresStop {
  converged,        ///< no step within the bounds promises a decrease beyond the tolerance
  reached,          ///< |r| <= target
  iteration_limit,  ///< max_iterations
  step_too_small,   ///< steps that decrease |r| became shorter than rounding, or r does not exist close by
};
std::string_view to_string(LeastSquaresStop stop);

struct LeastSquaresResult {
  Eigen::VectorXd x;
  double norm = 0;  ///< |r(x)|
  int iterations = 0;
  int evaluations = 0;  ///< of r
  LeastSquaresStop stopped = LeastSquaresStop::converged;
  bool defined = true;  ///< false where r does not exist at the start: then nothing was done
};

/// Minimizes |r(x)|^2 / 2 over lower <= x <= upper by a trust-region method: Gauss-Newton models, to which the secant
/// estimate of the residuals' curvature is added while it predicts better (Dennis, Gay and Welsch 1981, NL2SOL), so
/// that targets out of reach, whose residuals stay large, converge as fast. Each step minimizes the model over the box
/// that bounds and trust region (in the maximum norm, relative to the bounds' widths) leave, by an active-set method.
/// O(n^3) for each step beside the evaluations; n of tens at most. lower < upper are finite; x lies between.
/// `accepted`, where given, hears of each accepted point, the first included.
LeastSquaresResult minimize_least_squares(
    ResidualFunction& function, const Eigen::VectorXd& x, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
    const LeastSquaresOptions& options = {}, const Execution& execution = {},
    const std::function<void(const Eigen::VectorXd& x, double norm, int iteration)>& accepted = {});

/// argmin g^T s + s^T H s / 2 over lower <= s <= upper, which contain 0, for a symmetric positive definite H; by an
/// active-set method that ends at the exact minimizer. O(n^3) for each change of the active set.
Eigen::VectorXd minimize_quadratic_in_box(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& gradient,
                                          const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

}  // namespace supple::numerics
