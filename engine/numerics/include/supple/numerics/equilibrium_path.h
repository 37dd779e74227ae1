#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <concepts>
#include <limits>
#include <utility>
#include <vector>

#include "supple/base/execution.h"
#include "supple/numerics/cholesky.h"
#include "supple/numerics/least_stable_mode.h"
#include "supple/numerics/minimizer.h"

namespace supple::numerics {

/// How a path of equilibria is followed. Lengths of load steps are in whatever unit the scene measures its loads in.
struct PathOptions {
  /// Of each minimization; its tolerance, its limit of iterations and saddle_contraction are the path's.
  MinimizerOptions minimizer{};
  int max_iterations = 60;  ///< Newton iterations for one load step before it is halved
  /// The way from an unstable equilibrium to a stable one is long, and shorter load steps would not shorten it: times
  /// max_iterations.
  int more_iterations_after_leaving = 4;
  double largest_step = 1;
  double smallest_step = 1e-6;  ///< a load step is not divided below this
  /// A load step that took no more iterations lets the next one grow, by the factor.
  int quick_iterations = 6;
  double step_growth = 2;

  /// Whether an equilibrium that is not stable is left along its least stable mode, to the side of lower energy.
  bool leave_unstable = true;
  int max_branch_changes = 12;       ///< how often, since the counts were taken last
  double saddle_contraction = 0.03;  ///< see MinimizerOptions::saddle_contraction
  /// Steps along an unstable mode, in units of the scene's: the first, and how often it is doubled.
  double first_mode_step = 1e-3;
  int mode_doublings = 10;
  /// A curvature above minus this share of the mean diagonal entry of the Hessian is rounding, and no reason to leave.
  double zero_curvature = 1e-13;
};

enum class PathStop {
  converged,
  iteration_limit,  ///< the smallest load step did not converge
  step_too_small,   ///< no descent was found
};

/// What the scene is told about a load step that ended at an equilibrium.
struct Arrival {
  double share = 1;         ///< of the change that was announced
  bool same_branch = true;  ///< no unstable equilibrium was left on the way
  bool indefinite = false;  ///< a minimization on the way met a Hessian that is not positive definite
};

/// What follows a path: the energy and its state, what a load step changes and how the state ahead is guessed, and what
/// is worked out at an equilibrium. Everything else is the path's.
template <class Scene>
concept PathScene = requires(Scene scene, const Scene& fixed, typename Scene::State state, const Eigen::VectorXd& mode,
                             const MinimizerResult& result, const Arrival& arrival, double number) {
  /// The energy at the current state.
  { scene.objective() } -> std::convertible_to<Objective&>;
  /// Keeps its symbolic analysis, and after a minimization the last factorization.
  { scene.cholesky() } -> std::convertible_to<ShiftedCholesky&>;
  /// The current state with all that was worked out at it; putting it back makes it the current one.
  { fixed.state() } -> std::convertible_to<typename Scene::State>;
  scene.set_state(state);
  /// In the unit of the energy's gradient, for the current state.
  { scene.gradient_tolerance() } -> std::convertible_to<double>;
  /// Whether a minimization that converged has to be repeated, since the energy or the tolerance has changed.
  { scene.unsettled(result) } -> std::convertible_to<bool>;
  /// Works out what is wanted of an equilibrium. False where it is not stable.
  { scene.finish(result) } -> std::convertible_to<bool>;
  /// The same where it is not stable and stays so. False where that is not possible.
  { scene.finish_unstable() } -> std::convertible_to<bool>;
  /// Works out the tangent to what the announced load changes. Called at the start of a load step.
  scene.begin_step();
  /// Makes the likely equilibrium after this share of the announced change the current state. False where there is no
  /// valid one.
  { scene.predict(number) } -> std::convertible_to<bool>;
  scene.arrived(arrival);
  /// A direction of unknowns as one of all degrees of freedom, so long that PathOptions::first_mode_step times it is a
  /// first step.
  { fixed.unit_mode(mode) } -> std::convertible_to<Eigen::VectorXd>;
  { fixed.expand(mode) } -> std::convertible_to<Eigen::VectorXd>;
  /// Makes the state that lies `number` times the mode away from `state` the current one. False where it is not valid.
  { scene.move_along(state, mode, number) } -> std::convertible_to<bool>;
  /// The current state is one to which an unstable equilibrium was left.
  scene.left_branch();
};

/// Follows equilibria while loads change: each load step guesses the state ahead, minimizes the energy, looks whether
/// the equilibrium is stable, and where it is not goes down along its least stable mode. A step that fails is halved;
/// quick ones let the next one grow.
///
/// The scene and what the execution points to outlive the path.
template <PathScene Scene>
class EquilibriumPath {
 public:
  using State = typename Scene::State;

  EquilibriumPath(Scene& scene, const PathOptions& options, Execution execution)
      : scene_(scene), options_(options), execution_(std::move(execution)), step_(options.largest_step) {}

  /// The equilibrium at the loads that are now. False where none was found; `stopped` says why.
  bool settle() { return minimize(false); }

  enum class Progress { arrived, underway, failed };
  /// One load step of the change that the scene has announced, whose length is `size`. Where it fails, the state is the
  /// one before.
  Progress step(double size) {
    if (size == 0) return Progress::arrived;
    const Snapshot start = snapshot();
    scene_.begin_step();
    double share = std::min(1.0, step_ / size);
    // A remainder of a rounding error's size would be a step of its own.
    if (share > 1 - 1e-9) share = 1;
    while (true) {
      execution_.cancellation.throw_if_requested();
      const Counts before = counts_;
      indefinite_ = false;
      if (scene_.predict(share) && minimize(false)) {
        ++counts_.load_steps;
        if (counts_.iterations - before.iterations <= options_.quick_iterations)
          step_ = std::min(options_.largest_step, std::max(step_, share * size * options_.step_growth));
        scene_.arrived({share, counts_.branches_left == before.branches_left, indefinite_});
        return share == 1 ? Progress::arrived : Progress::underway;
      }
      const PathStop why = stopped_;
      restore(start);
      stopped_ = why;
      counts_.branches_left = before.branches_left;
      if (share * size / 2 < options_.smallest_step) {
        if (stopped_ == PathStop::converged) stopped_ = PathStop::step_too_small;
        return Progress::failed;
      }
      share /= 2;
      step_ = share * size;
    }
  }

  /// Steps from now on are at most so long; the next one is tried at that length.
  void set_largest_step(double size) { options_.largest_step = step_ = size; }

  /// Of each minimization from now on.
  void set_max_iterations(int most) { options_.max_iterations = most; }

  /// Adds `mode` (all degrees of freedom) to the state, as far as the energy falls, and settles. False where it falls
  /// nowhere.
  bool leave_along(const Eigen::VectorXd& mode) { return move_along(mode) && minimize(true); }

  /// From an equilibrium, looks for another one from `state` at the same loads. Goes over to it if it is stable and its
  /// energy is lower by more than the share `same_energy`: closer ones are mirror images.
  bool prefer_lower_from(const State& state, double same_energy) {
    const Snapshot found = snapshot();
    const int branches = counts_.branches_left;
    scene_.set_state(state);
    const double energy = found.result.value;
    const bool lower = minimize(false) && stable_ && result_.value < energy - same_energy * std::abs(energy);
    counts_.branches_left = branches + (lower ? 1 : 0);
    if (!lower) restore(found);
    stopped_ = PathStop::converged;
    return lower;
  }

  /// All that is known at the current state.
  struct Snapshot {
    State state;
    MinimizerResult result;
    bool stable = true;
    PathStop stopped = PathStop::converged;
  };
  Snapshot snapshot() const { return {std::as_const(scene_).state(), result_, stable_, stopped_}; }
  void restore(const Snapshot& snapshot) {
    scene_.set_state(snapshot.state);
    result_ = snapshot.result;
    stable_ = snapshot.stable;
    stopped_ = snapshot.stopped;
  }

  bool stable() const { return stable_; }
  PathStop stopped() const { return stopped_; }              ///< how the last attempt ended
  const MinimizerResult& result() const { return result_; }  ///< of the last minimization at this state

  struct Counts {
    int iterations = 0;
    int load_steps = 0;
    int branches_left = 0;
  };
  const Counts& counts() const { return counts_; }
  Counts take_counts() { return std::exchange(counts_, {}); }
  void set_branches_left(int branches) { counts_.branches_left = branches; }

 private:
  /// How often one minimization is repeated because the scene was not settled.
  static constexpr int max_repeats = 10;

  /// `left`: the state is one to which an unstable one was left, and may be far from equilibrium.
  bool minimize(bool left) {
    // The terms and the factorization write their own bills.
    const Execution inner{execution_.cancellation, nullptr, nullptr};
    MinimizerOptions options = options_.minimizer;
    options.saddle_contraction = options_.leave_unstable ? options_.saddle_contraction : 0;
    for (int repeats = 0;;) {
      options.gradient_tolerance = scene_.gradient_tolerance();
      options.max_iterations = options_.max_iterations * (left ? options_.more_iterations_after_leaving : 1);
      result_ = numerics::minimize(scene_.objective(), options, inner, &scene_.cholesky());
      counts_.iterations += result_.iterations;
      indefinite_ = indefinite_ || result_.indefinite;
      if (result_.stop == MinimizerStop::saddle) {
        if (leave_least_stable_mode()) {
          left = true;
        } else {
          options.saddle_contraction = 0;
        }
        continue;
      }
      if (result_.stop != MinimizerStop::converged) {
        stopped_ =
            result_.stop == MinimizerStop::iteration_limit ? PathStop::iteration_limit : PathStop::step_too_small;
        return false;
      }
      stopped_ = PathStop::converged;
      if (repeats++ < max_repeats && scene_.unsettled(std::as_const(result_))) continue;
      stable_ = scene_.finish(std::as_const(result_));
      if (stable_) return true;
      indefinite_ = true;
      if (!leave_least_stable_mode()) return scene_.finish_unstable();
      left = true;
    }
  }

  /// False, and the state is as it was, where there is nothing to leave or no state of less energy.
  bool leave_least_stable_mode() {
    if (!options_.leave_unstable || counts_.branches_left >= options_.max_branch_changes) return false;
    Objective& objective = scene_.objective();
    const Evaluation evaluation = objective.evaluate(2);
    const Mode mode =
        least_stable_mode(evaluation.hessian, objective.dimension(), scene_.cholesky(), execution_.cancellation);
    stable_ = mode.curvature >= -options_.zero_curvature * diagonal_scale(evaluation.hessian);
    return !stable_ && move_along(scene_.expand(mode.direction));
  }

  bool move_along(const Eigen::VectorXd& mode) {
    const Eigen::VectorXd unit = scene_.unit_mode(mode);
    const double energy = scene_.objective().evaluate(0).value;
    const State start = std::as_const(scene_).state();
    const auto energy_at = [&](double amount) {
      return scene_.move_along(start, unit, amount) ? scene_.objective().evaluate(0).value
                                                    : std::numeric_limits<double>::infinity();
    };
    const auto amount = lowest_along_mode(energy, options_.first_mode_step, options_.mode_doublings, energy_at);
    if (!amount || !scene_.move_along(start, unit, *amount)) {
      scene_.set_state(start);
      return false;
    }
    ++counts_.branches_left;
    if (execution_.cost)
      execution_.cost->add_effect("buckling", true, "the tangent stiffness was not positive definite", 1);
    scene_.left_branch();
    return true;
  }

  Scene& scene_;
  PathOptions options_;
  Execution execution_;
  MinimizerResult result_;
  bool stable_ = true;
  bool indefinite_ = false;
  PathStop stopped_ = PathStop::converged;
  double step_;  ///< length of the next load step
  Counts counts_;
};

}  // namespace supple::numerics
