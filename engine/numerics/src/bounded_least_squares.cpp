#include "supple/numerics/bounded_least_squares.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

namespace supple::numerics {
namespace {

/// Limits of the ratio of a step's decrease to the decrease that the model predicts. A step is accepted above the
/// first. The trust region shrinks below the second and grows above the third.
constexpr double min_accepted_ratio = 1e-4;
constexpr double shrink_ratio = 0.25;
constexpr double growth_ratio = 0.75;
/// Smallest radius of the trust region, relative to the bounds' widths. Shorter steps are rounding.
constexpr double min_radius = 1e-13;
/// Lower bound for a model's curvatures, relative to the largest.
constexpr double min_relative_curvature = 1e-10;

/// The same matrix with its eigenvalues raised to at least min_relative_curvature times the largest magnitude.
Eigen::MatrixXd convex(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(matrix);
  const double largest = eigen.eigenvalues().cwiseAbs().maxCoeff();
  const Eigen::VectorXd values = eigen.eigenvalues().cwiseMax(std::max(min_relative_curvature * largest, 1e-300));
  return eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
}

/// A quadratic model of the change of |r|^2 / 2, in unknowns scaled by the bounds' widths.
struct Model {
  Eigen::MatrixXd hessian;
  double change(const Eigen::VectorXd& gradient, const Eigen::VectorXd& step) const {
    return gradient.dot(step) + 0.5 * step.dot(hessian * step);
  }
};

class Solver {
 public:
  Solver(ResidualFunction& function, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
         const LeastSquaresOptions& options)
      : function_(function), lower_(lower), upper_(upper), width_(upper - lower), options_(options) {}

  LeastSquaresResult run(const Eigen::VectorXd& start, const Execution& execution,
                         const std::function<void(const Eigen::VectorXd&, double, int)>& accepted) {
    result_.x = start.cwiseMax(lower_).cwiseMin(upper_);
    result_.defined = evaluate(result_.x, r_);
    if (!result_.defined) {
      result_.stopped = LeastSquaresTermination::step_too_small;
      return result_;
    }
    differentiate();
    curvature_.setZero(start.size(), start.size());
    radius_ = options_.initial_radius;
    result_.norm = r_.norm();
    if (accepted) accepted(result_.x, result_.norm, 0);
    while (!terminates()) {
      execution.checkpoint(static_cast<double>(result_.iterations) / options_.max_iterations, "design");
      ++result_.iterations;
      if (advance() && accepted) accepted(result_.x, result_.norm, result_.iterations);
    }
    return result_;
  }

 private:
  bool evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& r) {
    ++result_.evaluations;
    return function_.residuals(x, r) && r.allFinite();
  }

  void differentiate() {
    function_.jacobian(jacobian_);
    jacobian_ = jacobian_ * width_.asDiagonal();
    gradient_ = jacobian_.transpose() * r_;
  }

  Model gauss_newton() const { return {convex(jacobian_.transpose() * jacobian_)}; }
  Model augmented() const { return {convex(jacobian_.transpose() * jacobian_ + curvature_)}; }

  /// Computes the next step. Returns whether the iteration ends, because no step is worth taking or a limit is reached.
  bool terminates() {
    if (result_.norm <= options_.target) return terminate(LeastSquaresTermination::reached);
    // A curvature estimate that is too large would end the search early, so both models have to agree.
    if (use_curvature_ && predicts_no_decrease(augmented())) use_curvature_ = false;
    if (!use_curvature_ && predicts_no_decrease(gauss_newton())) return terminate(LeastSquaresTermination::converged);
    if (radius_ < min_radius) return terminate(LeastSquaresTermination::step_too_small);
    if (result_.iterations == options_.max_iterations) return terminate(LeastSquaresTermination::iteration_limit);
    return false;
  }
  /// Uses this model for the next step. Returns whether it predicts no decrease beyond the tolerance, for a step that
  /// the trust region does not shorten.
  bool predicts_no_decrease(Model model) {
    model_ = std::move(model);
    step_ = trust_region_step(model_, radius_);
    const bool shortened = step_.cwiseAbs().maxCoeff() >= radius_ * (1 - 1e-12);
    const double predicted = -model_.change(gradient_, step_);
    const double predicted_norm = std::sqrt(std::max(0.0, result_.norm * result_.norm - 2 * predicted));
    return !shortened && result_.norm - predicted_norm <= options_.tolerance;
  }
  bool terminate(LeastSquaresTermination reason) {
    result_.stopped = reason;
    return true;
  }

  Eigen::VectorXd trust_region_step(const Model& model, double radius) const {
    const Eigen::VectorXd step_lower_bound = (lower_ - result_.x).cwiseQuotient(width_).cwiseMax(-radius).cwiseMin(0);
    const Eigen::VectorXd step_upper_bound = (upper_ - result_.x).cwiseQuotient(width_).cwiseMin(radius).cwiseMax(0);
    return minimize_quadratic_in_box(model.hessian, gradient_, step_lower_bound, step_upper_bound);
  }

  /// Evaluates at the step's end. Returns whether the step was accepted.
  bool advance() {
    const double length = step_.cwiseAbs().maxCoeff();
    const Eigen::VectorXd x = (result_.x + step_.cwiseProduct(width_)).cwiseMax(lower_).cwiseMin(upper_);
    Eigen::VectorXd r;
    if (!evaluate(x, r)) {
      radius_ = shrink_ratio * length;
      return false;
    }
    const double change = 0.5 * (r.squaredNorm() - r_.squaredNorm());
    const double ratio = change / model_.change(gradient_, step_);
    choose_model(change);
    if (ratio < shrink_ratio) {
      radius_ = shrink_ratio * length;
    } else if (ratio > growth_ratio && length >= 0.99 * radius_) {
      radius_ = std::min(1.0, 2 * radius_);
    }
    if (!(ratio > min_accepted_ratio)) return false;
    const Eigen::MatrixXd old_jacobian = jacobian_;
    const Eigen::VectorXd old_gradient = gradient_;
    result_.x = x;
    r_ = r;
    result_.norm = r_.norm();
    differentiate();
    update_curvature(old_gradient, gradient_ - old_jacobian.transpose() * r_);
    return true;
  }

  /// Chooses for the next step the model whose prediction was closer.
  void choose_model(double change) {
    const double with = std::abs(augmented().change(gradient_, step_) - change);
    const double without = std::abs(gauss_newton().change(gradient_, step_) - change);
    use_curvature_ = with < without;
  }

  /// The secant update of NL2SOL [Dennis1981], S step = y := J_+^T r_+ - J^T r_+. The sizing factor scales down the old
  /// S, so that outdated curvature does not persist.
  void update_curvature(const Eigen::VectorXd& old_gradient, const Eigen::VectorXd& y) {
    const Eigen::VectorXd change = gradient_ - old_gradient;
    const double slope = change.dot(step_);
    if (!(slope > 1e-14 * change.norm() * step_.norm())) return;
    const Eigen::VectorXd predicted_change = curvature_ * step_;
    const double predicted_curvature = step_.dot(predicted_change);
    const double sizing = predicted_curvature != 0 ? std::min(1.0, std::abs(step_.dot(y) / predicted_curvature)) : 1;
    const Eigen::VectorXd error = y - sizing * predicted_change;
    curvature_ = sizing * curvature_ + (error * change.transpose() + change * error.transpose()) / slope -
                 error.dot(step_) / (slope * slope) * change * change.transpose();
  }

  ResidualFunction& function_;
  Eigen::VectorXd lower_;
  Eigen::VectorXd upper_;
  Eigen::VectorXd width_;
  LeastSquaresOptions options_;
  LeastSquaresResult result_;
  Eigen::VectorXd r_;
  Eigen::MatrixXd jacobian_;   ///< dr/d(x / width), the unknowns of all members below
  Eigen::VectorXd gradient_;   ///< gradient of |r|^2 / 2
  Eigen::MatrixXd curvature_;  ///< estimate of sum r_i Hessian(r_i)
  Model model_;
  Eigen::VectorXd step_;
  double radius_ = 0;
  bool use_curvature_ = false;
};

/// The gradient of the model at s.
Eigen::VectorXd model_gradient(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& gradient,
                               const Eigen::VectorXd& s) {
  return gradient + hessian * s;
}

}  // namespace

std::string_view to_string(LeastSquaresTermination stop) {
  switch (stop) {
    case LeastSquaresTermination::reached:
      return "reached";
    case LeastSquaresTermination::iteration_limit:
      return "iteration_limit";
    case LeastSquaresTermination::step_too_small:
      return "step_too_small";
    default:
      return "converged";
  }
}

Eigen::VectorXd minimize_quadratic_in_box(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& gradient,
                                          const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) {
  const Eigen::Index n = gradient.size();
  Eigen::VectorXd s = Eigen::VectorXd::Zero(n);
  std::vector<bool> fixed(static_cast<std::size_t>(n), false);
  const auto is_fixed = [&fixed](Eigen::Index i) { return static_cast<bool>(fixed[static_cast<std::size_t>(i)]); };
  // Each iteration fixes a variable at the bound that blocks the step. If none does, the minimizer over the free
  // variables is reached, and a variable is released at whose bound the model falls inward. The model falls strictly
  // from one release to the next, so no active set repeats; only rounding can make the limit necessary.
  for (int iteration = 0; iteration < 50 * (static_cast<int>(n) + 1); ++iteration) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < n; ++i)
      if (!is_fixed(i)) free.push_back(i);
    const Eigen::VectorXd g = model_gradient(hessian, gradient, s);
    Eigen::VectorXd step = Eigen::VectorXd::Zero(n);
    if (!free.empty()) {
      const Eigen::MatrixXd reduced_hessian = hessian(free, free);
      const Eigen::VectorXd reduced_gradient = g(free);
      const Eigen::VectorXd newton = reduced_hessian.ldlt().solve(reduced_gradient);
      step(free) = -newton;
    }
    double fraction = 1;
    Eigen::Index blocking = -1;
    for (const Eigen::Index i : free) {
      const double distance = step[i] > 0 ? upper[i] - s[i] : lower[i] - s[i];
      if (step[i] != 0 && distance / step[i] < fraction) {
        fraction = std::max(0.0, distance / step[i]);
        blocking = i;
      }
    }
    s += fraction * step;
    if (blocking >= 0) {
      s[blocking] = step[blocking] > 0 ? upper[blocking] : lower[blocking];
      fixed[static_cast<std::size_t>(blocking)] = true;
      continue;
    }
    const Eigen::VectorXd end = model_gradient(hessian, gradient, s);
    Eigen::Index release = -1;
    double steepest = 1e-14 * gradient.norm();
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!is_fixed(i) || lower[i] == upper[i]) continue;
      const double inward = s[i] >= upper[i] ? end[i] : -end[i];
      if (inward > steepest) {
        steepest = inward;
        release = i;
      }
    }
    if (release < 0) break;
    fixed[static_cast<std::size_t>(release)] = false;
  }
  return s;
}

LeastSquaresResult minimize_least_squares(ResidualFunction& function, const Eigen::VectorXd& x,
                                          const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                          const LeastSquaresOptions& options, const Execution& execution,
                                          const std::function<void(const Eigen::VectorXd&, double, int)>& accepted) {
  return Solver(function, lower, upper, options).run(x, execution, accepted);
}

}  // namespace supple::numerics
