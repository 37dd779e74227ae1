#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "supple/base/execution.h"
#include "supple/numerics/cholesky.h"
#include "supple/numerics/equilibrium_path.h"
#include "supple/weave/equilibrium.h"
#include "weave_system.h"

namespace supple::weave {

/// A change of the values of fixed degrees of freedom (mm, rad; for a spatial joint its rotation vector) and of the
/// fraction of the forces.
struct LoadStep {
  Eigen::VectorXd change;     ///< zero at degrees of freedom that are not prescribed
  double force_fraction = 1;  ///< at its end
  int min_increments = 1;
};

/// A weave whose loads change, for numerics::EquilibriumPath. Lengths of load increments are fractions of the LoadStep
/// that is followed. The objective has the whole state: positions, sliding, frames and joints. Functions without a
/// comment are those of numerics::PathScene.
class WeaveScene {
 public:
  WeaveScene(WeaveSystem& objective, const EquilibriumOptions& options, CostLedger* cost);

  struct State {
    Eigen::VectorXd q;
    Chart chart;
    double force_fraction = 0;
  };
  WeaveSystem& objective() { return objective_; }
  numerics::ShiftedCholesky& cholesky() { return cholesky_; }
  State state() const { return {objective_.q(), objective_.chart(), force_fraction_}; }
  void set_state(const State& state);
  double gradient_tolerance();  ///< N
  bool must_minimize_again(const numerics::MinimizerResult&) const { return false; }
  bool finish(const numerics::MinimizerResult& result);
  bool finish_unstable();
  void begin_step();
  bool predict(double fraction);
  void finish_load_step(const numerics::LoadStepResult& arrival);
  Eigen::VectorXd expand(const Eigen::VectorXd& y) const { return objective_.expand(y); }
  Eigen::VectorXd unit_mode(const Eigen::VectorXd& mode) const;  ///< scaled so that its largest entry is 1 mm or rad
  bool move_along(const State& from, const Eigen::VectorXd& mode, double amount);
  void left_branch() { factorized_ = false; }

  /// Starts following `step` from the current state. `step` must exist as long as it is followed.
  void begin(const LoadStep& step);
  double remaining() const { return 1 - completed_; }  ///< fraction of the step
  void set_force_fraction(double fraction);
  double force_fraction() const { return force_fraction_; }
  std::optional<Eigen::VectorXd> take_bifurcation() { return std::exchange(bifurcation_, std::nullopt); }
  double tolerance() const { return tolerance_; }

 private:
  /// Factorizes the Hessian at the current state in `cholesky_`. Returns false if that is not possible.
  bool factorize();
  void prescribe(double fraction, Eigen::VectorXd& q) const;
  double force_fraction_after(double fraction) const;
  void remember_bifurcation();

  WeaveSystem& objective_;
  numerics::ShiftedCholesky cholesky_;
  bool leaves_unstable_;
  double tolerance_;
  double force_fraction_ = 0;
  bool factorized_ = false;  ///< whether `cholesky_` has the Hessian of the current state

  // State of the load step that is being followed:
  const LoadStep* step_ = nullptr;
  double completed_ = 0;                        ///< fraction of the step
  double force_fraction_before_ = 0;            ///< at the beginning of the step
  State start_;                                 ///< beginning of the increment that is tried
  Eigen::VectorXd tangent_;                     ///< derivative of the state by the load at `start_`; empty if unknown
  Eigen::VectorXd predicted_;                   ///< state in which the last minimization began
  std::optional<Eigen::VectorXd> bifurcation_;  ///< see WeavePath::take_bifurcation
};

/// Equilibria of a weave along a load path. The search for each starts from the previous one.
class WeavePath {
 public:
  WeavePath(WeaveSystem& objective, const EquilibriumOptions& options, Execution execution);

  /// Sets the fraction of the forces that belongs to the current state.
  void resume_at(double force_fraction) { scene_.set_force_fraction(force_fraction); }

  /// Finds the equilibrium at the present loads. Returns false if none was found; `termination` says why.
  bool find_equilibrium() { return path_.find_equilibrium(); }

  /// Follows the step to its end, in at least as many increments as it asks for. Returns false if that is not possible;
  /// the state is then the last equilibrium on the path.
  bool advance(const LoadStep& step);

  /// Leaves an equilibrium along `mode` (all degrees of freedom) as far as the energy falls, and finds the equilibrium
  /// beyond. Returns false if no step lowers the energy.
  bool leave_along(const Eigen::VectorXd& mode) { return path_.leave_along(mode); }

  /// The first state, since the last call, from which a minimization met an indefinite Hessian: a bifurcation, at which
  /// rounding decides to which branch the path continues. It is recorded for planar cells with sliders only, since
  /// sheets have too many bifurcations.
  std::optional<Eigen::VectorXd> take_bifurcation() { return scene_.take_bifurcation(); }

  /// Looks for another equilibrium from `state` at the same loads. It becomes the current one if it is stable and has
  /// less than `energy`; `energy_there` computes its energy while it is current.
  bool prefer_lower_from(const WeaveScene::State& state, double energy, const std::function<double()>& energy_there);
  WeaveScene::State state() const { return scene_.state(); }

  double energy() const { return path_.result().value; }
  double residual() const { return path_.result().gradient_norm; }  ///< |g|, N
  double tolerance() const { return scene_.tolerance(); }
  double force_fraction() const { return scene_.force_fraction(); }
  bool stable() const { return path_.stable(); }
  Stop termination() const;
  int iterations() const { return path_.counts().iterations; }
  int load_steps() const { return path_.counts().load_steps; }
  int branches_left() const { return path_.counts().branches_left; }
  double reached() const { return reached_; }  ///< fraction of the last step that was followed
  /// |g| after every iteration of the last minimization, N.
  const std::vector<numerics::MinimizerStep>& history() const { return path_.result().history; }

 private:
  WeaveScene scene_;
  Execution execution_;
  numerics::EquilibriumPath<WeaveScene> path_;
  double reached_ = 1;
};

/// Options for minimizing the energies of weaves.
numerics::MinimizerOptions minimizer_options();

/// Tolerance of the gradient for EquilibriumOptions::tolerance = `relative`, N.
double absolute_tolerance(const RodModel& model, double relative);

}  // namespace supple::weave
