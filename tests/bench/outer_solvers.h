#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "supple/numerics/bounded_least_squares.h"

namespace supple::bench {

/// Residuals r of unknowns u that are scaled to the unit box, x = lower + u (upper - lower), and what a solver has
/// asked of them. A point that is asked for twice in a row is evaluated once.
class RecordedResiduals : public numerics::ResidualFunction {
 public:
  /// Time counts from here on.
  RecordedResiduals(numerics::ResidualFunction& function, Eigen::VectorXd lower, Eigen::VectorXd upper);

  bool residuals(const Eigen::VectorXd& u, Eigen::VectorXd& r) override;
  void jacobian(Eigen::MatrixXd& jacobian) override;

  /// When |r| became less than ever before.
  struct Improvement {
    double norm = 0;
    double seconds = 0;  ///< CPU time since the beginning
  };
  const std::vector<Improvement>& improvements() const { return improvements_; }
  /// Where |r| was least.
  const Eigen::VectorXd& best() const { return best_; }
  int evaluations() const { return evaluations_; }  ///< of r
  int jacobians() const { return jacobians_; }
  int undefined() const { return undefined_; }  ///< evaluations of r where it does not exist

 private:
  numerics::ResidualFunction& function_;
  Eigen::VectorXd lower_;
  Eigen::VectorXd upper_;
  double begun_ = 0;
  Eigen::VectorXd last_;
  Eigen::VectorXd last_residuals_;
  bool last_defined_ = false;
  Eigen::MatrixXd last_jacobian_;  ///< empty where it has not been asked for
  std::vector<Improvement> improvements_;
  Eigen::VectorXd best_;
  int evaluations_ = 0;
  int jacobians_ = 0;
  int undefined_ = 0;
};

enum class Ending {
  converged,
  limit,    ///< too many evaluations
  gave_up,  ///< the solver calls it a failure
};

/// All solvers end where |r| <= this, or after an accepted step that has lessened |r| by at most this. (Ours ends
/// before a step that promises no more.)
inline constexpr double outer_tolerance = 1e-9;
/// Residuals are evaluated about this often at most: iterations of ours and of Ceres.
inline constexpr int most_evaluations = 500;

/// Minimizes |r(u)|^2 / 2 over the unit box from a start where r exists.
struct OuterSolver {
  std::string key;   ///< in CSV files
  std::string name;  ///< on the page
  Ending (*run)(RecordedResiduals& residuals, const Eigen::VectorXd& start);
};
/// numerics::minimize_least_squares first, then its rivals: Ceres with Levenberg-Marquardt and dogleg steps, and the
/// reference implementation of L-BFGS-B (version 3.0, Morales and Nocedal 2011).
const std::vector<OuterSolver>& outer_solvers();

}  // namespace supple::bench
