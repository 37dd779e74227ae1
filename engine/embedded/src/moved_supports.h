#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "host_model.h"
#include "network_state.h"
#include "supple/embedded/host.h"
#include "supple/numerics/equilibrium_path.h"
#include "supple/numerics/system.h"

namespace supple::embedded {

/// A network and a deformable host of which some vertices are moved, as a scene for numerics::EquilibriumPath. The load
/// says how far the vertices are: k at the k-th of their positions, 0 at the first state.
class MovedSupports {
 public:
  struct State {
    NetworkState network;
    double load = 0;
  };

  /// `system` has the moved vertices at their first places and counts their coordinates as fixed. `system` and `host`
  /// outlive this.
  MovedSupports(numerics::System<NetworkState>& system, const HostModel& host, double gradient_tolerance);

  /// The largest number of positions of a vertex.
  std::size_t position_count() const { return positions_.size() - 1; }
  /// Sets the load to which steps go from now on; at most the next whole number.
  void set_target(double load) { target_ = load; }
  double target() const { return target_; }
  double load() const { return load_; }
  /// Returns to the state at the start of the load increment.
  void restart_step() { set_state(start_); }
  numerics::System<NetworkState>& system() { return system_; }
  /// Says whether the states that follow only test the path, so that observers are not told of them.
  void set_on_trial(bool on_trial) { on_trial_ = on_trial; }
  bool is_on_trial() const { return on_trial_; }

  // The interface of numerics::PathScene:
  numerics::Objective& objective() { return system_; }
  numerics::ShiftedCholesky& cholesky() { return cholesky_; }
  State state() const { return {std::as_const(system_).state(), load_}; }
  void set_state(const State& state);
  double gradient_tolerance() const { return gradient_tolerance_; }
  bool must_minimize_again(const numerics::MinimizerResult&) { return false; }
  /// Returns whether the equilibrium is stable.
  bool finish(const numerics::MinimizerResult& result);
  bool finish_unstable() { return true; }
  void begin_step();
  bool predict(double fraction);
  void finish_load_step(const numerics::LoadStepResult&) {}
  Eigen::VectorXd unit_mode(const Eigen::VectorXd& mode) const;
  Eigen::VectorXd expand(const Eigen::VectorXd& mode) const { return system_.expand(mode); }
  bool move_along(const State& from, const Eigen::VectorXd& mode, double amount);
  void left_branch() {}

  /// Says whether the present state is no equilibrium, because a path under compression is at its cut locus. The energy
  /// has no tangent of equilibria there, so load increments begin with the response of the host alone.
  void set_at_kink(bool at_kink) { at_kink_ = at_kink; }
  /// Moves network and host together with the supports, if these move as one rigid body and the energy stays the same.
  /// Returns false otherwise, and leaves the state as it was.
  bool move_rigidly();

  /// Whether the equilibrium of this energy, found from the last prediction, is another one than that at the start of
  /// the load increment: whether the energy fell by much more than the error of the prediction explains.
  bool has_jumped(double energy) const;
  /// Distance of the present state from the last prediction over the distance of the prediction from the start of the
  /// load increment, of all positions of nodes and points together. O(points + nodes).
  double prediction_error() const;

 private:
  /// Moves from a state; returns false, and may leave any state, where an element would be turned inside out.
  bool try_step(const State& from, const Eigen::VectorXd& step, double load);
  /// Makes the step or the same step with points that keep their barycentric coordinates, whichever leads to the lower
  /// energy. Returns false if neither is valid.
  bool take_lower_step(const Eigen::VectorXd& step, double load);
  /// The change of all degrees of freedom with which the host follows its supports to a load as one rigid body; nothing
  /// where the supports do not move as one.
  std::optional<Eigen::VectorXd> rigid_motion(const NetworkState& from, double load) const;
  /// Moves to the target as a rigid body, if that is an equilibrium.
  bool predict_rigid_motion();
  /// The change of the host's own gradient since the start of the load increment.
  Eigen::VectorXd host_gradient_change(const NetworkState& carried) const;
  void store_prediction();
  /// The change that moved vertices prescribe from a state to a load; 0 for all other degrees of freedom.
  Eigen::VectorXd prescribed_change(const NetworkState& from, double load) const;
  /// The tangent to the path of equilibria, from the change of the gradient on a short part of the prescribed change.
  void compute_tangent(const NetworkState& carried, Eigen::VectorXd unbalanced);
  bool factorize_at_start(const numerics::Evaluation& here);

  numerics::System<NetworkState>& system_;
  const HostModel& host_;
  std::vector<std::int32_t> vertices_;      ///< moved vertices
  std::vector<std::int32_t> supports_;      ///< all fixed nodes; empty if some node has one or two fixed coordinates
  std::vector<Eigen::VectorXd> positions_;  ///< coordinates of the moved vertices: at first, then at each position
  double gradient_tolerance_;
  double load_ = 0;
  double target_ = 0;
  numerics::ShiftedCholesky cholesky_;
  State start_;               ///< start of the load increment
  Eigen::VectorXd tangent_;   ///< change of all degrees of freedom from there to the target, to first order
  bool has_factors_ = false;  ///< whether `cholesky_` has the factors of the matrix at the start
  bool at_kink_ = false;
  bool on_trial_ = false;
  Eigen::VectorXd prediction_;  ///< positions of nodes and points
  double predicted_energy_ = 0;
  double predicted_decrease_ = 0;  ///< decrease of the energy from the prediction by a Newton step
};

}  // namespace supple::embedded
