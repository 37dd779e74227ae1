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

/// A network and a host that gives way, of which some held vertices are moved, as numerics::EquilibriumPath follows
/// them. The load is how far these are on their ways: k at the k-th of their positions, 0 where they were at first.
class MovedSupports {
 public:
  /// Where points and nodes are, and how far the moved vertices.
  struct State {
    NetworkState network;
    double load = 0;
  };

  /// `system` has the moved vertices where they are at first, among what it holds; it outlives this.
  MovedSupports(numerics::System<NetworkState>& system, const HostModel& host, double gradient_tolerance);

  /// The most positions that a vertex has.
  std::size_t stops() const { return stops_.size() - 1; }
  /// The load that steps go to from now on: not beyond the next whole number.
  void announce(double load) { announced_ = load; }
  double announced() const { return announced_; }
  double load() const { return load_; }
  /// Back to where the load step began.
  void restart_step() { set_state(start_); }
  numerics::System<NetworkState>& system() { return system_; }
  /// Tells whether states are tried that are no part of the path.
  void set_on_trial(bool on_trial) { on_trial_ = on_trial; }
  bool is_on_trial() const { return on_trial_; }

  // What numerics::PathScene asks for.
  numerics::Objective& objective() { return system_; }
  numerics::ShiftedCholesky& cholesky() { return cholesky_; }
  State state() const { return {std::as_const(system_).state(), load_}; }
  void set_state(const State& state);
  double gradient_tolerance() const { return gradient_tolerance_; }
  bool unsettled(const numerics::MinimizerResult&) { return false; }
  /// Whether it is stable.
  bool finish(const numerics::MinimizerResult& result);
  bool finish_unstable() { return true; }
  void begin_step();
  bool predict(double share);
  void arrived(const numerics::Arrival&) {}
  Eigen::VectorXd unit_mode(const Eigen::VectorXd& mode) const;
  Eigen::VectorXd expand(const Eigen::VectorXd& mode) const { return system_.expand(mode); }
  bool move_along(const State& from, const Eigen::VectorXd& mode, double amount);
  void left_branch() {}

  /// Tells whether the present state is none of equilibrium, since a path that pushes is at its cut locus. Load steps
  /// then begin with the response of the host alone: no tangent is known.
  void set_at_kink(bool at_kink) { at_kink_ = at_kink; }
  /// Moves network and host as a whole to where the supports go, if these go the way of one rigid body and that does
  /// not change the energy. Returns false otherwise; the state is then as before.
  bool carry_rigidly();

  /// Whether the equilibrium that was found after the last prediction, with this energy, is another one than that at
  /// the start of the load step: the energy fell by much more than the prediction was off.
  bool has_jumped(double energy) const;
  /// How far the present state is from the last prediction, over how far the prediction is from the start of the load
  /// step: of all positions of nodes and points together. O(points + nodes).
  double missed_share() const;

 private:
  bool go(const State& from, const Eigen::VectorXd& step, double load);
  /// The change of all degrees of freedom by which the host moves as a whole to where its supports are at a load; none
  /// where these do not all go the way of one rigid body.
  std::optional<Eigen::VectorXd> rigid_motion(const NetworkState& from, double load) const;
  /// Makes the current state that of a rigid motion, if this is an equilibrium.
  bool predict_rigid_motion();
  /// How much more the host alone is out of balance at a state than at the start of the load step.
  Eigen::VectorXd unbalanced_host(const NetworkState& carried) const;
  /// Makes the current state that of a step, or the one in which points stay in their places in the material, whichever
  /// has the lower energy. Returns false if neither is valid.
  bool go_lower(const Eigen::VectorXd& step, double load);
  void note_prediction();
  /// The change of all degrees of freedom from a state to a load that moved vertices prescribe; 0 for all others.
  Eigen::VectorXd way_of_supports(const NetworkState& from, double load) const;

  numerics::System<NetworkState>& system_;
  std::vector<std::int32_t> vertices_;  ///< those that are moved
  std::vector<std::int32_t> supports_;  ///< all nodes that are held; empty where some are held to some directions only
  std::vector<Eigen::VectorXd> stops_;  ///< coordinates of the moved vertices: at first, then at each position
  double gradient_tolerance_;
  double load_ = 0;
  double announced_ = 0;
  numerics::ShiftedCholesky cholesky_;
  State start_;               ///< of the load step
  Eigen::VectorXd tangent_;   ///< of all degrees of freedom at its start, for all of the announced change
  bool has_factors_ = false;  ///< whether `cholesky_` was factorized at the start of the load step
  bool at_kink_ = false;
  bool on_trial_ = false;
  Eigen::VectorXd prediction_;     ///< positions of nodes and points
  double predicted_energy_ = 0;    ///< that of the last prediction
  double predicted_decrease_ = 0;  ///< of the energy from there, by the factors that are known
};

}  // namespace supple::embedded
