#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <concepts>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "supple/base/execution.h"
#include "supple/numerics/cholesky.h"
#include "supple/numerics/least_stable_mode.h"
#include "supple/numerics/minimizer.h"

namespace supple::numerics {

/// Options of an equilibrium path. Load steps are measured in the unit of the scene's loads.
struct PathOptions {
  /// Options of each minimization. The path overwrites its gradient_tolerance, max_iterations and saddle_contraction.
  MinimizerOptions minimizer{};
  int max_iterations = 60;  ///< Newton iterations of one minimization, before its load step is halved
  /// Factor of max_iterations for a minimization that begins at a state to which an unstable equilibrium was left. Such
  /// a state is far from the stable equilibrium, and a shorter load step would not bring it nearer.
  int iteration_factor_after_leaving = 4;
  /// Maximum number of repetitions of one minimization at the scene's request (`must_minimize_again`). A state that has
  /// to be minimized again then is no equilibrium of the scene.
  int max_repeats = 10;
  double largest_step = 1;
  double smallest_step = 1e-6;  ///< a load step is not divided below this length
  /// After a load step of at most this many Newton iterations, the next one may be longer by the factor `step_growth`.
  int quick_iterations = 6;
  double step_growth = 2;

  /// Whether an unstable equilibrium is left along its least stable mode, to the side of lower energy.
  bool leave_unstable = true;
  /// Maximum number of times that an equilibrium is left, between two calls of take_counts.
  int max_branch_changes = 12;
  double saddle_contraction = 0.03;  ///< see MinimizerOptions::saddle_contraction
  /// Steps along an unstable mode: length of the first one, in the scene's unit, and maximum number of doublings.
  double first_mode_step = 1e-3;
  int mode_doublings = 10;
  /// An equilibrium counts as stable if its least curvature is at least -curvature_tolerance * matrix_scale(H): smaller
  /// negative ones are rounding.
  double curvature_tolerance = 1e-13;
};

enum class PathTermination {
  converged,
  iteration_limit,  ///< the smallest load step did not converge within the iterations or repetitions
  step_too_small,   ///< no descent direction led to a lower energy
};

/// What the scene is told about a load step that ended at an equilibrium.
struct LoadStepResult {
  double fraction = 1;      ///< of the announced change of the load, in (0, 1]
  bool same_branch = true;  ///< whether this load step left no unstable equilibrium
  bool indefinite = false;  ///< whether one of its minimizations met a Hessian that is not positive definite
};

/// The scene whose equilibria a path follows. It has the energy and its state. It says what a load step changes, how
/// the next state is predicted, and what is computed at an equilibrium. The path does everything else.
template <class Scene>
concept PathScene = requires(Scene scene, const Scene& fixed, typename Scene::State state, const Eigen::VectorXd& mode,
                             const MinimizerResult& result, const LoadStepResult& arrival, double number) {
  /// The energy at the current state.
  { scene.objective() } -> std::convertible_to<Objective&>;
  /// The factorization. It keeps its symbolic analysis and, after a minimization, the last factors.
  { scene.cholesky() } -> std::convertible_to<ShiftedCholesky&>;
  /// The current state with everything that was computed at it. `set_state` makes such a state the current one again.
  { fixed.state() } -> std::convertible_to<typename Scene::State>;
  scene.set_state(state);
  /// The tolerance of |g| at the current state, in the unit of the energy's gradient.
  { scene.gradient_tolerance() } -> std::convertible_to<double>;
  /// Whether a minimization that converged has to be repeated, because the energy or the tolerance has changed.
  { scene.must_minimize_again(result) } -> std::convertible_to<bool>;
  /// Computes the scene's results at an equilibrium. Returns false if the equilibrium is not stable.
  { scene.finish(result) } -> std::convertible_to<bool>;
  /// Computes the same results at an unstable equilibrium that is not left. Returns false if that is not possible.
  { scene.finish_unstable() } -> std::convertible_to<bool>;
  /// Computes the tangent of the state with respect to the announced change of the load. It is called at the start of a
  /// load step.
  scene.begin_step();
  /// Predicts the equilibrium after this fraction of the announced change, and makes it the current state. Returns
  /// false if the prediction is not a valid state.
  { scene.predict(number) } -> std::convertible_to<bool>;
  scene.finish_load_step(arrival);
  /// `unit_mode` scales a direction of all degrees of freedom such that PathOptions::first_mode_step times it is a
  /// first step. `expand` writes a direction of the unknowns as one of all degrees of freedom.
  { fixed.unit_mode(mode) } -> std::convertible_to<Eigen::VectorXd>;
  { fixed.expand(mode) } -> std::convertible_to<Eigen::VectorXd>;
  /// Moves from `state` by `number` times the mode and makes the result the current state. Returns false if it is
  /// invalid.
  { scene.move_along(state, mode, number) } -> std::convertible_to<bool>;
  /// Called when an unstable equilibrium was left and the current state is the lower one that was found.
  scene.left_branch();
};

/// Follows equilibria while loads change. Each load step predicts the next state, minimizes the energy and checks
/// whether the equilibrium is stable. If it is not, the path descends along the least stable mode. A load step that
/// fails is halved, and after one of few iterations the next may be longer.
///
/// The scene, and what the execution points to, must outlive the path.
template <PathScene Scene>
class EquilibriumPath {
 public:
  using State = typename Scene::State;

  EquilibriumPath(Scene& scene, const PathOptions& options, Execution execution)
      : scene_(scene), options_(options), execution_(std::move(execution)), step_(options.largest_step) {}

  /// Finds the equilibrium at the present loads. Returns false if none was found; `stopped()` then says why.
  bool find_equilibrium() { return minimize(false); }

  enum class Progress { complete, partial, failed };
  /// Makes one load step towards the change that the scene has announced, whose length is `size`. If it fails, the
  /// state from before is restored.
  Progress step(double size) {
    if (size == 0) return Progress::complete;
    const Snapshot start = snapshot();
    scene_.begin_step();
    double fraction = std::min(1.0, step_ / size);
    // Otherwise the rounding error of the last fraction would be left as a load step of its own.
    if (fraction > 1 - 1e-9) fraction = 1;
    while (true) {
      execution_.cancellation.throw_if_requested();
      const Counts before = counts_;
      indefinite_ = false;
      if (scene_.predict(fraction) && minimize(false)) {
        ++counts_.load_steps;
        if (counts_.iterations - before.iterations <= options_.quick_iterations)
          step_ = std::min(options_.largest_step, std::max(step_, fraction * size * options_.step_growth));
        scene_.finish_load_step({fraction, counts_.branches_left == before.branches_left, indefinite_});
        return fraction == 1 ? Progress::complete : Progress::partial;
      }
      const PathTermination why = termination_;
      restore(start);
      termination_ = why;
      counts_.branches_left = before.branches_left;
      if (fraction * size / 2 < options_.smallest_step) {
        if (termination_ == PathTermination::converged) termination_ = PathTermination::step_too_small;
        return Progress::failed;
      }
      fraction /= 2;
      step_ = fraction * size;
    }
  }

  /// Sets the maximum length of load steps from now on. The next step is tried at that length.
  void set_largest_step(double size) { options_.largest_step = step_ = size; }

  /// Sets the maximum number of iterations of each minimization from now on.
  void set_max_iterations(int iterations) { options_.max_iterations = iterations; }

  /// Moves along `mode` (all degrees of freedom) as far as the energy falls, and finds the equilibrium from there.
  /// Returns false if the energy falls nowhere along the mode.
  bool leave_along(const Eigen::VectorXd& mode) { return move_along(mode) && minimize(true); }

  /// Looks for another equilibrium at the same loads, starting from `state`. The path adopts it if it is stable and if
  /// its energy is lower by more than `same_energy`, relative to the energy; mirror images differ by less.
  bool prefer_lower_from(const State& state, double same_energy) {
    return prefer_lower_from(state, same_energy, result_.value, [this] { return result_.value; });
  }
  /// The same, comparing energies other than those that the path minimizes. `energy` belongs to the present state.
  /// `other_energy()` is called when the other equilibrium is the current state, and returns its energy.
  template <class Energy>
  bool prefer_lower_from(const State& state, double same_energy, double energy, const Energy& other_energy) {
    const Snapshot found = snapshot();
    const int branches = counts_.branches_left;
    scene_.set_state(state);
    const bool lower = minimize(false) && stable_ && other_energy() < energy - same_energy * std::abs(energy);
    counts_.branches_left = branches + (lower ? 1 : 0);
    if (!lower) restore(found);
    termination_ = PathTermination::converged;
    return lower;
  }

  /// The current state, and everything that the path knows about it.
  struct Snapshot {
    State state;
    MinimizerResult result;
    bool stable = true;
    PathTermination stopped = PathTermination::converged;
  };
  Snapshot snapshot() const { return {std::as_const(scene_).state(), result_, stable_, termination_}; }
  void restore(const Snapshot& snapshot) {
    scene_.set_state(snapshot.state);
    result_ = snapshot.result;
    stable_ = snapshot.stable;
    termination_ = snapshot.stopped;
  }

  bool stable() const { return stable_; }
  PathTermination stopped() const { return termination_; }   ///< how the last minimization ended
  const MinimizerResult& result() const { return result_; }  ///< result of the last minimization at this state

  struct Counts {
    int iterations = 0;
    int load_steps = 0;
    int branches_left = 0;
  };
  const Counts& counts() const { return counts_; }
  Counts take_counts() { return std::exchange(counts_, {}); }
  /// Overwrites the counts, so that a trial computation is not counted.
  void set_counts(const Counts& counts) { counts_ = counts; }
  void set_branches_left(int branches) { counts_.branches_left = branches; }

 private:
  /// `after_leaving`: whether an unstable equilibrium was just left, so that the state may be far from equilibrium.
  bool minimize(bool after_leaving) {
    // The minimizer bills nothing here: the terms and the factorization write to the ledger themselves.
    const Execution inner{execution_.cancellation, nullptr, nullptr};
    MinimizerOptions options = options_.minimizer;
    options.saddle_contraction = options_.leave_unstable ? options_.saddle_contraction : 0;
    for (int repeats = 0;;) {
      options.gradient_tolerance = scene_.gradient_tolerance();
      options.max_iterations = options_.max_iterations * (after_leaving ? options_.iteration_factor_after_leaving : 1);
      result_ = numerics::minimize(scene_.objective(), options, inner, &scene_.cholesky());
      counts_.iterations += result_.iterations;
      indefinite_ = indefinite_ || result_.indefinite;
      if (result_.stop == MinimizerTermination::saddle) {
        if (leave_least_stable_mode()) {
          after_leaving = true;
        } else {
          options.saddle_contraction = 0;
        }
        continue;
      }
      if (result_.stop != MinimizerTermination::converged) {
        termination_ = result_.stop == MinimizerTermination::iteration_limit ? PathTermination::iteration_limit
                                                                             : PathTermination::step_too_small;
        return false;
      }
      termination_ = PathTermination::converged;
      if (scene_.must_minimize_again(std::as_const(result_))) {
        if (repeats++ < options_.max_repeats) continue;
        termination_ = PathTermination::iteration_limit;
        return false;
      }
      stable_ = scene_.finish(std::as_const(result_));
      if (stable_) return true;
      indefinite_ = true;
      if (!leave_least_stable_mode()) return scene_.finish_unstable();
      after_leaving = true;
    }
  }

  /// Returns false and restores the state if the equilibrium is stable, may not be left, or no lower state was found.
  /// An equilibrium without a least stable mode (see least_stable_mode) counts as unstable.
  bool leave_least_stable_mode() {
    if (!options_.leave_unstable || counts_.branches_left >= options_.max_branch_changes) return false;
    Objective& objective = scene_.objective();
    const Evaluation evaluation = objective.evaluate(2);
    const std::optional<Mode> mode =
        least_stable_mode(evaluation.hessian, objective.dimension(), scene_.cholesky(), execution_.cancellation);
    stable_ = mode && mode->curvature >= -options_.curvature_tolerance * matrix_scale(evaluation.hessian);
    return mode && !stable_ && move_along(scene_.expand(mode->direction));
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
  PathTermination termination_ = PathTermination::converged;
  double step_;  ///< length of the next load step
  Counts counts_;
};

}  // namespace supple::numerics
