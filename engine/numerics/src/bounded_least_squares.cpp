#include "supple/numerics/bounded_least_squares.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

namespace supple::numerics {
namespace {

/// A step is accepted if it brings this share of the decrease that the model predicts,
constexpr double least_share = 1e-4;
/// the trust region shrinks below this share and grows above that one.
constexpr double poor_share = 0.25;
constexpr double good_share = 0.75;
/// Of the trust region relative to the bounds' widths: below, steps are rounding.
constexpr double least_radius = 1e-13;
/// Smallest eigenvalue of a model's Hessian over its largest.
constexpr double least_curvature = 1e-10;

/// The same matrix with no eigenvalue below a share of the largest.
Eigen::MatrixXd convex(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(matrix);
  const double largest = eigen.eigenvalues().cwiseAbs().maxCoeff();
  const Eigen::VectorXd values = eigen.eigenvalues().cwiseMax(std::max(least_curvature * largest, 1e-300));
  return eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
}

/// A quadratic model of the decrease of |r|^2 / 2, in unknowns scaled by the bounds' widths.
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
      result_.stopped = LeastSquaresStop::step_too_small;
      return result_;
    }
    differentiate();
    curvature_.setZero(start.size(), start.size());
    radius_ = options_.initial_radius;
    result_.norm = r_.norm();
    if (accepted) accepted(result_.x, result_.norm, 0);
    while (!stops()) {
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

  /// Works out the next step, and whether there is none worth taking.
  bool stops() {
    if (result_.norm <= options_.target) return stop(LeastSquaresStop::reached);
    // An estimate of the curvature that is too large would end the search early, so that both models have to agree.
    if (use_curvature_ && promises_nothing(augmented())) use_curvature_ = false;
    if (!use_curvature_ && promises_nothing(gauss_newton())) return stop(LeastSquaresStop::converged);
    if (radius_ < least_radius) return stop(LeastSquaresStop::step_too_small);
    if (result_.iterations == options_.max_iterations) return stop(LeastSquaresStop::iteration_limit);
    return false;
  }
  /// Makes the model's step the next one.
  bool promises_nothing(Model model) {
    model_ = std::move(model);
    step_ = step_of(model_, radius_);
    const bool shortened = step_.cwiseAbs().maxCoeff() >= radius_ * (1 - 1e-12);
    const double promised = -model_.change(gradient_, step_);
    const double promised_norm = std::sqrt(std::max(0.0, result_.norm * result_.norm - 2 * promised));
    return !shortened && result_.norm - promised_norm <= options_.tolerance;
  }
  bool stop(LeastSquaresStop why) {
    result_.stopped = why;
    return true;
  }

  Eigen::VectorXd step_of(const Model& model, double radius) const {
    const Eigen::VectorXd least = (lower_ - result_.x).cwiseQuotient(width_).cwiseMax(-radius).cwiseMin(0);
    const Eigen::VectorXd most = (upper_ - result_.x).cwiseQuotient(width_).cwiseMin(radius).cwiseMax(0);
    return minimize_quadratic_in_box(model.hessian, gradient_, least, most);
  }

  /// Tries the step; true if it was accepted.
  bool advance() {
    const double length = step_.cwiseAbs().maxCoeff();
    const Eigen::VectorXd x = (result_.x + step_.cwiseProduct(width_)).cwiseMax(lower_).cwiseMin(upper_);
    Eigen::VectorXd r;
    if (!evaluate(x, r)) {
      radius_ = poor_share * length;
      return false;
    }
    const double change = 0.5 * (r.squaredNorm() - r_.squaredNorm());
    const double share = change / model_.change(gradient_, step_);
    choose_model(change);
    if (share < poor_share) {
      radius_ = poor_share * length;
    } else if (share > good_share && length >= 0.99 * radius_) {
      radius_ = std::min(1.0, 2 * radius_);
    }
    if (!(share > least_share)) return false;
    const Eigen::MatrixXd old_jacobian = jacobian_;
    const Eigen::VectorXd old_gradient = gradient_;
    result_.x = x;
    r_ = r;
    result_.norm = r_.norm();
    differentiate();
    update_curvature(old_gradient, gradient_ - old_jacobian.transpose() * r_);
    return true;
  }

  /// The model whose prediction was closer is used next.
  void choose_model(double change) {
    const double with = std::abs(augmented().change(gradient_, step_) - change);
    const double without = std::abs(gauss_newton().change(gradient_, step_) - change);
    use_curvature_ = with < without;
  }

  /// The secant update of NL2SOL: S step = J_+^T r_+ - J^T r_+ =: y, sized so that old curvature does not linger.
  void update_curvature(const Eigen::VectorXd& old_gradient, const Eigen::VectorXd& y) {
    const Eigen::VectorXd change = gradient_ - old_gradient;
    const double slope = change.dot(step_);
    if (!(slope > 1e-14 * change.norm() * step_.norm())) return;
    const Eigen::VectorXd known = curvature_ * step_;
    const double old = step_.dot(known);
    const double size = old != 0 ? std::min(1.0, std::abs(step_.dot(y) / old)) : 1;
    const Eigen::VectorXd error = y - size * known;
    curvature_ = size * curvature_ + (error * change.transpose() + change * error.transpose()) / slope -
                 error.dot(step_) / (slope * slope) * change * change.transpose();
  }

  ResidualFunction& function_;
  Eigen::VectorXd lower_;
  Eigen::VectorXd upper_;
  Eigen::VectorXd width_;
  LeastSquaresOptions options_;
  LeastSquaresResult result_;
  Eigen::VectorXd r_;
  Eigen::MatrixXd jacobian_;   ///< with respect to x / width, like all that follows
  Eigen::VectorXd gradient_;   ///< of |r|^2 / 2
  Eigen::MatrixXd curvature_;  ///< estimate of sum r_i Hessian(r_i)
  Model model_;
  Eigen::VectorXd step_;
  double radius_ = 0;
  bool use_curvature_ = false;
};

/// The gradient of the model at s.
Eigen::VectorXd slope(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& gradient, const Eigen::VectorXd& s) {
  return gradient + hessian * s;
}

}  // namespace

std::string_view to_string(LeastSquaresStop stop) {
  switch (stop) {
    case LeastSquaresStop::reached:
      return "reached";
    case LeastSquaresStop::iteration_limit:
      return "iteration_limit";
    case LeastSquaresStop::step_too_small:
      return "step_too_small";
    default:
      return "converged";
  }
}

Eigen::VectorXd minimize_quadratic_in_box(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& gradient,
                                          const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) {
  const Eigen::Index n = gradient.size();
  Eigen::VectorXd s = Eigen::VectorXd::Zero(n);
  std::vector<bool> held(static_cast<std::size_t>(n), false);
  const auto is_held = [&held](Eigen::Index i) { return static_cast<bool>(held[static_cast<std::size_t>(i)]); };
  // Each round fixes a variable at its bound or ends at the minimizer over the free ones, after which one variable
  // whose bound no longer pushes is released. The energy falls strictly from one release to the next, so that no active
  // set returns; the limit is for rounding alone.
  for (int round = 0; round < 50 * (static_cast<int>(n) + 1); ++round) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < n; ++i)
      if (!is_held(i)) free.push_back(i);
    const Eigen::VectorXd g = slope(hessian, gradient, s);
    Eigen::VectorXd step = Eigen::VectorXd::Zero(n);
    if (!free.empty()) {
      const Eigen::MatrixXd block = hessian(free, free);
      const Eigen::VectorXd part = g(free);
      const Eigen::VectorXd newton = block.ldlt().solve(part);
      step(free) = -newton;
    }
    double share = 1;
    Eigen::Index blocking = -1;
    for (const Eigen::Index i : free) {
      const double room = step[i] > 0 ? upper[i] - s[i] : lower[i] - s[i];
      if (step[i] != 0 && room / step[i] < share) {
        share = std::max(0.0, room / step[i]);
        blocking = i;
      }
    }
    s += share * step;
    if (blocking >= 0) {
      s[blocking] = step[blocking] > 0 ? upper[blocking] : lower[blocking];
      held[static_cast<std::size_t>(blocking)] = true;
      continue;
    }
    const Eigen::VectorXd end = slope(hessian, gradient, s);
    Eigen::Index release = -1;
    double steepest = 1e-14 * gradient.norm();
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!is_held(i) || lower[i] == upper[i]) continue;
      const double inward = s[i] >= upper[i] ? end[i] : -end[i];
      if (inward > steepest) {
        steepest = inward;
        release = i;
      }
    }
    if (release < 0) break;
    held[static_cast<std::size_t>(release)] = false;
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
