#include "outer_solvers.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "measurement.h"

// L-BFGS-B 3.0, in Fortran: lengths of strings come last.
extern "C" void setulb_(const int* n, const int* m, double* x, const double* l, const double* u, const int* nbd,
                        double* f, double* g, const double* factr, const double* pgtol, double* wa, int* iwa,
                        char* task, const int* iprint, char* csave, int* lsave, int* isave, double* dsave,
                        std::size_t task_length, std::size_t csave_length);

namespace supple::bench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Tests of the rivals' own are only for points where rounding leaves nothing to do.
constexpr double rounding = 1e-13;

Ending solve_ours(RecordedResiduals& residuals, const VectorXd& start) {
  const auto n = start.size();
  const auto result = numerics::minimize_least_squares(
      residuals, start, VectorXd::Zero(n), VectorXd::Ones(n),
      {.tolerance = outer_tolerance, .target = outer_tolerance, .max_iterations = most_evaluations});
  if (result.stopped == numerics::LeastSquaresStop::iteration_limit) return Ending::limit;
  return result.stopped == numerics::LeastSquaresStop::step_too_small ? Ending::gave_up : Ending::converged;
}

class CeresCost : public ceres::CostFunction {
 public:
  CeresCost(RecordedResiduals& residuals, Eigen::Index unknowns, Eigen::Index count) : residuals_(residuals) {
    mutable_parameter_block_sizes()->push_back(static_cast<int>(unknowns));
    set_num_residuals(static_cast<int>(count));
  }

  bool Evaluate(const double* const* parameters, double* values, double** jacobians) const override {
    const int n = parameter_block_sizes().front();
    VectorXd r;
    if (!residuals_.residuals(Eigen::Map<const VectorXd>(parameters[0], n), r)) return false;
    Eigen::Map<VectorXd>(values, num_residuals()) = r;
    if (jacobians && jacobians[0]) {
      MatrixXd jacobian;
      residuals_.jacobian(jacobian);
      using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      Eigen::Map<RowMajor>(jacobians[0], num_residuals(), n) = jacobian;
    }
    return true;
  }

 private:
  RecordedResiduals& residuals_;
};

/// Ends Ceres by the test that all solvers share.
class CeresStop : public ceres::IterationCallback {
 public:
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    const double norm = std::sqrt(2 * summary.cost);
    const double before = std::sqrt(2 * std::max(0.0, summary.cost + summary.cost_change));
    const bool slow = summary.iteration > 0 && summary.step_is_successful && before - norm <= outer_tolerance;
    return norm <= outer_tolerance || slow ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }
};

Ending solve_with_ceres(RecordedResiduals& residuals, const VectorXd& start, ceres::TrustRegionStrategyType strategy) {
  VectorXd r;
  residuals.residuals(start, r);
  VectorXd u = start;
  CeresCost cost(residuals, u.size(), r.size());
  CeresStop stop;
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  problem.AddResidualBlock(&cost, nullptr, u.data());
  for (int k = 0; k < u.size(); ++k) {
    problem.SetParameterLowerBound(u.data(), k, 0);
    problem.SetParameterUpperBound(u.data(), k, 1);
  }
  ceres::Solver::Options options;
  options.trust_region_strategy_type = strategy;
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = most_evaluations;
  // Residuals that do not exist call for a shorter step, however often.
  options.max_num_consecutive_invalid_steps = most_evaluations;
  options.function_tolerance = 0;
  options.gradient_tolerance = rounding;
  options.parameter_tolerance = rounding;
  options.callbacks.push_back(&stop);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (summary.termination_type == ceres::NO_CONVERGENCE) return Ending::limit;
  return summary.IsSolutionUsable() ? Ending::converged : Ending::gave_up;
}

Ending solve_levenberg_marquardt(RecordedResiduals& residuals, const VectorXd& start) {
  return solve_with_ceres(residuals, start, ceres::LEVENBERG_MARQUARDT);
}

Ending solve_dogleg(RecordedResiduals& residuals, const VectorXd& start) {
  return solve_with_ceres(residuals, start, ceres::DOGLEG);
}

/// |r|^2 / 2 and its gradient for L-BFGS-B, which asks for both at every point.
class Objective {
 public:
  explicit Objective(RecordedResiduals& residuals) : residuals_(residuals) {}

  void evaluate(const VectorXd& u, double& f, VectorXd& g) {
    VectorXd r;
    if (residuals_.residuals(u, r)) {
      MatrixXd jacobian;
      residuals_.jacobian(jacobian);
      f = 0.5 * r.squaredNorm();
      g = jacobian.transpose() * r;
      return;
    }
    // It cannot be told that a value does not exist: one that rises as the accepted point promised to fall makes the
    // line search try a step of about a seventh.
    f = accepted_value_ + std::abs(accepted_gradient_.dot(u - accepted_));
    g = -accepted_gradient_;
  }

  /// How far |r| has fallen since the accepted point before.
  double accept(const VectorXd& u, double f, const VectorXd& g) {
    const double fall = std::sqrt(2 * accepted_value_) - std::sqrt(2 * f);
    accepted_ = u;
    accepted_value_ = f;
    accepted_gradient_ = g;
    return fall;
  }

 private:
  RecordedResiduals& residuals_;
  VectorXd accepted_;
  double accepted_value_ = 0;
  VectorXd accepted_gradient_;
};

Ending solve_lbfgsb(RecordedResiduals& residuals, const VectorXd& start) {
  const int n = static_cast<int>(start.size());
  const int pairs = 10;  // of steps and gradient changes that are kept: more than the unknowns
  const int silent = -1;
  const double no_test = 0;
  const VectorXd lower = VectorXd::Zero(n);
  const VectorXd upper = VectorXd::Ones(n);
  const Eigen::VectorXi both_bounds = Eigen::VectorXi::Constant(n, 2);
  VectorXd workspace = VectorXd::Zero(2 * pairs * n + 5 * n + 11 * pairs * pairs + 8 * pairs);
  Eigen::VectorXi integers = Eigen::VectorXi::Zero(3 * n);
  std::array<char, 60> task{};
  std::array<char, 60> text{};
  std::array<int, 4> lsave{};
  std::array<int, 44> isave{};
  std::array<double, 29> dsave{};
  task.fill(' ');
  text.fill(' ');
  std::string_view("START").copy(task.data(), task.size());
  const auto says = [&task](std::string_view what) { return std::string_view(task.data(), what.size()) == what; };

  Objective objective(residuals);
  VectorXd u = start;
  VectorXd g;
  double f = 0;
  objective.evaluate(u, f, g);
  objective.accept(u, f, g);
  while (residuals.evaluations() < most_evaluations) {
    setulb_(&n, &pairs, u.data(), lower.data(), upper.data(), both_bounds.data(), &f, g.data(), &no_test, &rounding,
            workspace.data(), integers.data(), task.data(), &silent, text.data(), lsave.data(), isave.data(),
            dsave.data(), task.size(), text.size());
    if (says("FG")) {
      objective.evaluate(u, f, g);
    } else if (says("NEW_X")) {
      if (objective.accept(u, f, g) <= outer_tolerance || std::sqrt(2 * f) <= outer_tolerance) return Ending::converged;
    } else {
      return says("CONVERGENCE") ? Ending::converged : Ending::gave_up;
    }
  }
  return Ending::limit;
}

}  // namespace

RecordedResiduals::RecordedResiduals(numerics::ResidualFunction& function, VectorXd lower, VectorXd upper)
    : function_(function), lower_(std::move(lower)), upper_(std::move(upper)), begun_(cpu_seconds()) {}

bool RecordedResiduals::residuals(const VectorXd& u, VectorXd& r) {
  if (last_.size() == 0 || u != last_) {
    last_ = u;
    last_jacobian_.resize(0, 0);
    ++evaluations_;
    const VectorXd x = (lower_ + u.cwiseProduct(upper_ - lower_)).cwiseMax(lower_).cwiseMin(upper_);
    last_defined_ = function_.residuals(x, last_residuals_) && last_residuals_.allFinite();
    if (!last_defined_) ++undefined_;
    if (last_defined_ && (improvements_.empty() || last_residuals_.norm() < improvements_.back().norm)) {
      improvements_.push_back({last_residuals_.norm(), cpu_seconds() - begun_});
      best_ = u;
    }
  }
  if (last_defined_) r = last_residuals_;
  return last_defined_;
}

void RecordedResiduals::jacobian(MatrixXd& jacobian) {
  if (last_jacobian_.size() == 0) {
    ++jacobians_;
    function_.jacobian(last_jacobian_);
    last_jacobian_ = last_jacobian_ * (upper_ - lower_).asDiagonal();
  }
  jacobian = last_jacobian_;
}

const std::vector<OuterSolver>& outer_solvers() {
  static const std::vector<OuterSolver> all{{"ours", "Ours", solve_ours},
                                            {"ceres_lm", "Ceres, Levenberg-Marquardt", solve_levenberg_marquardt},
                                            {"ceres_dogleg", "Ceres, dogleg", solve_dogleg},
                                            {"lbfgsb", "L-BFGS-B", solve_lbfgsb}};
  return all;
}

}  // namespace supple::bench
