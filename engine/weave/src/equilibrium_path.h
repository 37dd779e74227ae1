#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "supple/base/execution.h"
#include "supple/numerics/cholesky.h"
#include "supple/numerics/minimizer.h"
#include "supple/weave/equilibrium.h"
#include "weave_objective.h"

namespace supple::weave {

/// A change of what is prescribed: of held degrees of freedom (mm, rad; of a spatial joint its rotation vector) and of
/// the forces' share.
struct LoadStep {
  Eigen::VectorXd change;  ///< zero where nothing is prescribed
  double force_share = 1;  ///< at its end
  int parts = 1;           ///< at least
};

/// Equilibria of a weave along a load path, each found from the one before. The objective carries the whole state:
/// positions, sliding, frames and joints.
class EquilibriumPath {
 public:
  EquilibriumPath(WeaveObjective& objective, const EquilibriumOptions& options, Execution execution);

  /// The state is one at this share of the forces.
  void resume_at(double force_share);

  /// The equilibrium at the loads that are now. False where none was found; `stopped` says why.
  bool settle();

  /// Follows the step to its end, in as many parts as it asks for, or more if it takes them. False where it could not;
  /// the state is then the last equilibrium on the way.
  bool advance(const LoadStep& step);

  /// From an equilibrium, a step along `mode` (all degrees of freedom) as far as the energy falls, and the equilibrium
  /// beyond. False where no step lowers the energy.
  bool leave_along(const Eigen::VectorXd& mode);

  /// The first state, since the last call, in which a way down began on a ridge: rounding decided to which side it
  /// went. Of cells that slide in the plane; of sheets there are too many.
  std::optional<Eigen::VectorXd> take_ridge() { return std::exchange(ridge_, std::nullopt); }

  /// From an equilibrium, looks for another one from `q` at the same loads, and goes over to it if its energy is lower
  /// and it is stable.
  bool prefer_lower_from(Eigen::VectorXd q);

  double energy() const { return energy_; }
  double residual() const { return residual_; }  ///< |g|, N
  double tolerance() const { return tolerance_; }
  bool stable() const { return stable_; }
  Stop stopped() const { return stopped_; }
  int iterations() const { return iterations_; }
  int load_steps() const { return load_steps_; }
  int branches_left() const { return branches_left_; }
  double reached() const { return reached_; }  ///< share of the last step that was followed
  /// Of the last minimization: |g| after every iteration, N.
  const std::vector<numerics::MinimizerStep>& history() const { return history_; }

 private:
  bool minimize(bool left);
  bool positive_definite();
  bool leave_least_stable_mode();
  bool move_along(const Eigen::VectorXd& mode);
  Eigen::VectorXd response(const LoadStep& step, double share_now);
  bool try_part(const LoadStep& step, double part, const Eigen::VectorXd& response);
  void note_ridge(Eigen::VectorXd from);
  void prescribe(const Eigen::VectorXd& change, double part, Eigen::VectorXd& q) const;

  WeaveObjective& objective_;
  EquilibriumOptions options_;
  Execution execution_;
  numerics::ShiftedCholesky cholesky_;
  double tolerance_;
  double force_share_ = 0;
  double energy_ = 0;
  double residual_ = 0;
  bool stable_ = true;
  bool factorized_ = false;  ///< `cholesky_` holds the Hessian of the current state
  bool indefinite_ = false;  ///< the last minimization met a Hessian that is not positive definite
  Stop stopped_ = Stop::converged;
  int iterations_ = 0;
  int load_steps_ = 0;
  int branches_left_ = 0;
  std::optional<Eigen::VectorXd> ridge_;  ///< from where a minimization met an indefinite Hessian
  double reached_ = 1;
  std::vector<numerics::MinimizerStep> history_;
};

/// See EquilibriumOptions::tolerance; N.
double absolute_tolerance(const RodModel& model, double relative);

}  // namespace supple::weave
