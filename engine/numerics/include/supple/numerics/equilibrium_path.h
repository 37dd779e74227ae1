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

/// How a path of equilibria is followed. Lengths of load steps are in the unit in which the scene measures its loads.
struct PathOptions {
  /// The options of each minimization. Its tolerance, its limit of iterations and saddle_contraction are set by the
  /// path.
  MinimizerOptions minimizer{};
  int max_iterations = 60;  ///< Newton iterations for one load step before it is halved
  /// The way from an unstable equilibrium to a stable one is long, and shorter load steps would not shorten it. This
  /// factor multiplies max_iterations there.
  int more_iterations_after_leaving = 4;
  double largest_step = 1;
  double smallest_step = 1e-6;  ///< a load step is not divided below this
  /// A load step that took no more iterations than this lets the next one grow by the factor.
  int quick_iterations = 6;
  double step_growth = 2;

  /// Whether an equilibrium that is not stable is left along its least stable mode, to the side of lower energy.
  bool leave_unstable = true;
  int max_branch_changes = 12;       ///< how often it is left, since the counts were last taken
  double saddle_contraction = 0.03;  ///< see MinimizerOptions::saddle_contraction
  /// Steps along an unstable mode, in the scene's unit: the first step, and how often it is doubled.
  double first_mode_step = 1e-3;
  int mode_doublings = 10;
  /// A curvature above minus this share of the Hessian's scale (matrix_scale) is rounding and no reason to leave.
  double zero_curvature = 1e-13;
};

enum class PathStop {
  converged,
  iteration_limit,  ///< the smallest load step did not converge
  step_too_small,   ///< no descent was found
};

/// What the scene is told about a load step that ended at an equilibrium.
struct Arrival {
  double share = 1;         ///< share of the announced change
  bool same_branch = true;  ///< whether no unstable equilibrium was left on the way
  bool indefinite = false;  ///< whether a minimization on the way met a Hessian that is not positive definite
};

/// The scene that a path follows. It has the energy and its state, and it says what a load step changes, how the next
/// state is predicted, and what is computed at an equilibrium. The path does everything else.
template <class Scene>
concept PathScene = requires(Scene scene, const Scene& fixed, typename Scene::State state, const Eigen::VectorXd& mode,
                             const MinimizerResult& result, const Arrival& arrival, double number) {
  /// The energy at the current state.
  { scene.objective() } -> std::convertible_to<Objective&>;
  /// The factorization. It keeps its symbolic analysis and, after a minimization, the last factors.
  { scene.cholesky() } -> std::convertible_to<ShiftedCholesky&>;
  /// The current state with everything that was computed at it. Putting it back makes it the current one.
  { fixed.state() } -> std::convertible_to<typename Scene::State>;
  scene.set_state(state);
  /// The tolerance for the current state, in the unit of the energy's gradient.
  { scene.gradient_tolerance() } -> std::convertible_to<double>;
  /// Whether a minimization that converged has to be repeated, because the energy or the tolerance has changed.
  { scene.unsettled(result) } -> std::convertible_to<bool>;
  /// Computes what is wanted at an equilibrium. Returns false if it is not stable.
  { scene.finish(result) } -> std::convertible_to<bool>;
  /// Computes the same at an equilibrium that is not stable and stays so. Returns false if that is not possible.
  { scene.finish_unstable() } -> std::convertible_to<bool>;
  /// Computes the tangent of the state with respect to the announced change of the load. Called at the start of a load
  /// step.
  scene.begin_step();
  /// Makes the predicted equilibrium after this share of the announced change the current state. Returns false if there
  /// is no valid one.
  { scene.predict(number) } -> std::convertible_to<bool>;
  scene.arrived(arrival);
  /// A direction of the unknowns as a direction of all degrees of freedom. Its length is such that
  /// PathOptions::first_mode_step times it is a first step.
  { fixed.unit_mode(mode) } -> std::convertible_to<Eigen::VectorXd>;
  { fixed.expand(mode) } -> std::convertible_to<Eigen::VectorXd>;
  /// Makes the state that lies `number` times the mode away from `state` the current one. Returns false if it is
  /// invalid.
  { scene.move_along(state, mode, number) } -> std::convertible_to<bool>;
  /// Called when the current state is one to which an unstable equilibrium was left.
  scene.left_branch();
};

/// Follows equilibria while loads change. Each load step predicts the next state, minimizes the energy, checks whether
/// the equilibrium is stable, and goes down along its least stable mode if it is not. A step that fails is halved, and
/// quick steps let the next one grow.
///
/// The scene and what the execution points to must outlive the path.
template <PathScene Scene>
class EquilibriumPath {
 public:
  using State = typename Scene::State;

  EquilibriumPath(Scene& scene, const PathOptions& options, Execution execution)
      : scene_(scene), options_(options), execution_(std::move(execution)), step_(options.largest_step) {}

  /// Finds the equilibrium at the present loads. Returns false if none was found; `stopped` says why.
  bool settle() { return minimize(false); }

  enum class Progress { arrived, underway, failed };
  /// Makes one load step of the change that the scene has announced, whose length is `size`. If it fails, the state is
  /// the one before.
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

  /// From now on steps are at most so long. The next step is tried at that length.
  void set_largest_step(double size) { options_.largest_step = step_ = size; }

  /// Sets the limit of iterations of each minimization from now on.
  void set_max_iterations(int most) { options_.max_iterations = most; }

  /// Adds `mode` (all degrees of freedom) to the state as far as the energy falls, and finds the equilibrium there.
  /// Returns false if the energy falls nowhere.
  bool leave_along(const Eigen::VectorXd& mode) { return move_along(mode) && minimize(true); }

  /// From an equilibrium, looks for another one from `state` at the same loads. Goes over to it if it is stable and its
  /// energy is lower by more than the share `same_energy`: closer ones are mirror images.
  bool prefer_lower_from(const State& state, double same_energy) {
    return prefer_lower_from(state, same_energy, result_.value, [this] { return result_.value; });
  }
  /// The same for energies other than those that the path minimizes: `energy` is that of the present state, and
  /// `energy_there()` that of the other one, when it is the present one.
  template <class Energy>
  bool prefer_lower_from(const State& state, double same_energy, double energy, const Energy& energy_there) {
    const Snapshot found = snapshot();
    const int branches = counts_.branches_left;
    scene_.set_state(state);
    const bool lower = minimize(false) && stable_ && energy_there() < energy - same_energy * std::abs(energy);
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
  /// What was made on trial is not counted.
  void set_counts(const Counts& counts) { counts_ = counts; }
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
    stable_ = mode.curvature >= -options_.zero_curvature * matrix_scale(evaluation.hessian);
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
