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

/// A change of what is prescribed: of held degrees of freedom (mm, rad; of a spatial joint its rotation vector) and of
/// the forces' share.
struct LoadStep {
  Eigen::VectorXd change;  ///< zero where nothing is prescribed
  double force_share = 1;  ///< at its end
  int parts = 1;           ///< at least
};

/// A weave whose loads change, for numerics::EquilibriumPath. Lengths of load steps are shares of the LoadStep that is
/// followed. The objective carries the whole state: positions, sliding, frames and joints.
class WeaveScene {
 public:
  WeaveScene(WeaveSystem& objective, const EquilibriumOptions& options, CostLedger* cost);

  struct State {
    Eigen::VectorXd q;
    Chart chart;
    double force_share = 0;
  };
  WeaveSystem& objective() { return objective_; }
  numerics::ShiftedCholesky& cholesky() { return cholesky_; }
  State state() const { return {objective_.q(), objective_.chart(), force_share_}; }
  void set_state(const State& state);
  double gradient_tolerance();  ///< N
  bool unsettled(const numerics::MinimizerResult&) const { return false; }
  bool finish(const numerics::MinimizerResult& result);
  bool finish_unstable();
  void begin_step();
  bool predict(double share);
  void arrived(const numerics::Arrival& arrival);
  Eigen::VectorXd expand(const Eigen::VectorXd& y) const { return objective_.expand(y); }
  Eigen::VectorXd unit_mode(const Eigen::VectorXd& mode) const;  ///< whose largest entry is 1 mm or rad
  bool move_along(const State& from, const Eigen::VectorXd& mode, double amount);
  void left_branch() { factorized_ = false; }

  /// `step` is followed from the current state on; it outlives the following.
  void begin(const LoadStep& step);
  double remaining() const { return 1 - done_; }  ///< share of the step
  void set_force_share(double share);
  double force_share() const { return force_share_; }
  std::optional<Eigen::VectorXd> take_ridge() { return std::exchange(ridge_, std::nullopt); }
  double tolerance() const { return tolerance_; }

 private:
  /// What the objective's Hessian at the current state is factorized in `cholesky_`; false where it cannot be.
  bool factorize();
  void prescribe(double share, Eigen::VectorXd& q) const;
  double share_after(double share) const;
  void note_ridge();

  WeaveSystem& objective_;
  numerics::ShiftedCholesky cholesky_;
  bool leaves_unstable_;
  double tolerance_;
  double force_share_ = 0;
  bool factorized_ = false;  ///< `cholesky_` holds the Hessian of the current state

  // Of the load step that is under way:
  const LoadStep* step_ = nullptr;
  double done_ = 0;
  double share_before_ = 0;
  State start_;                           ///< of the part that is tried
  Eigen::VectorXd along_;                 ///< the tangent there; empty where there is none
  Eigen::VectorXd predicted_;             ///< where the last minimization began
  std::optional<Eigen::VectorXd> ridge_;  ///< from where a minimization met an indefinite Hessian
};

/// Equilibria of a weave along a load path, each found from the one before.
class WeavePath {
 public:
  WeavePath(WeaveSystem& objective, const EquilibriumOptions& options, Execution execution);

  /// The state is one at this share of the forces.
  void resume_at(double force_share) { scene_.set_force_share(force_share); }

  /// The equilibrium at the loads that are now. False where none was found; `stopped` says why.
  bool settle() { return path_.settle(); }

  /// Follows the step to its end, in as many parts as it asks for, or more if it takes them. False where it could not;
  /// the state is then the last equilibrium on the way.
  bool advance(const LoadStep& step);

  /// From an equilibrium, a step along `mode` (all degrees of freedom) as far as the energy falls, and the equilibrium
  /// beyond. False where no step lowers the energy.
  bool leave_along(const Eigen::VectorXd& mode) { return path_.leave_along(mode); }

  /// The first state, since the last call, in which a way down began on a ridge: rounding decided to which side it
  /// went. Of cells that slide in the plane; of sheets there are too many.
  std::optional<Eigen::VectorXd> take_ridge() { return scene_.take_ridge(); }

  /// From an equilibrium, looks for another one from `state` at the same loads, and goes over to it if its energy is
  /// lower than `energy` and it is stable. `energy_there` measures the energy when the path is there.
  bool prefer_lower_from(const WeaveScene::State& state, double energy, const std::function<double()>& energy_there);
  WeaveScene::State state() const { return scene_.state(); }

  double energy() const { return path_.result().value; }
  double residual() const { return path_.result().gradient_norm; }  ///< |g|, N
  double tolerance() const { return scene_.tolerance(); }
  double force_share() const { return scene_.force_share(); }
  bool stable() const { return path_.stable(); }
  Stop stopped() const;
  int iterations() const { return path_.counts().iterations; }
  int load_steps() const { return path_.counts().load_steps; }
  int branches_left() const { return path_.counts().branches_left; }
  double reached() const { return reached_; }  ///< share of the last step that was followed
  /// Of the last minimization: |g| after every iteration, N.
  const std::vector<numerics::MinimizerStep>& history() const { return path_.result().history; }

 private:
  WeaveScene scene_;
  Execution execution_;
  numerics::EquilibriumPath<WeaveScene> path_;
  double reached_ = 1;
};

/// How energies of weaves are minimized.
numerics::MinimizerOptions minimizer_options();

/// See EquilibriumOptions::tolerance; N.
double absolute_tolerance(const RodModel& model, double relative);

}  // namespace supple::weave
