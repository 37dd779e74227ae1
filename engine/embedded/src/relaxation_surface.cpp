// How a network follows a surface that moves along given positions.
#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>

#include "moving_network.h"
#include "point_damping.h"
#include "relaxation_phases.h"

namespace supple::embedded {
namespace {

using Termination = numerics::MinimizerTermination;

/// Lengths of load increments; the way from one position to the next has the length 1. Where an equilibrium is lost,
/// shorter increments than the first do not find a nearer one. Where a search meets its limit of iterations, searches
/// after increments shorter than the second do, too.
constexpr double min_surface_increment = 1.0 / 64;
constexpr double min_unfinished_increment = 1.0 / 8;
/// If going back to the load before finds an energy that differs by at most this fraction, the equilibrium is so near
/// the lost one that shorter increments would hardly find a nearer one.
constexpr double near_equilibrium = 1e-2;
/// A load increment with at most this many iterations lets the next one be twice as long.
constexpr int quick_iterations = 6;
/// A decrease of the energy by less than this fraction is no loss of an equilibrium: rounding and the tolerance of the
/// gradient cause about as much.
constexpr double min_loss = 1e-9;

class SurfaceFollower {
 public:
  SurfaceFollower(const RelaxationContext& context, Equilibrium start, const MovingHost& host,
                  RelaxationHistory& history, const Execution& execution)
      : context_(context),
        host_(host),
        history_(history),
        execution_(execution),
        minimizer_(context.minimizer_options()),
        now_(std::move(start)),
        scene_(context.solver, context.elements, std::make_shared<PointDamping>(context.points.stiffness),
               context.search_options(false).paths, host, {now_.state.points(), 0, now_.state.cut_loci()},
               minimizer_.gradient_tolerance, context.execution),
        path_(scene_, path_options(), execution_) {}

  FollowedEquilibrium run(const OnPosition& on_position) {
    std::vector<LoadIncrement> stops;
    const std::size_t count = host_.positions.size();
    for (std::size_t k = 1; k <= count; ++k) {
      execution_.checkpoint(static_cast<double>(k - 1) / static_cast<double>(count), "step");
      stops.push_back(follow_to(static_cast<double>(k)));
      take_scene();
      on_position(now_, stops);
    }
    return {std::move(now_), std::move(stops)};
  }

 private:
  using Path = numerics::EquilibriumPath<MovingNetwork>;

  numerics::PathOptions path_options() {
    numerics::PathOptions options;
    options.minimizer = minimizer_;
    options.minimizer.after_step = [this](const numerics::MinimizerStep& step) {
      if (step.step_length > 0) history_.record(step, scene_.system().state());
    };
    options.max_iterations = context_.options.max_iterations;
    options.leave_unstable = false;
    return options;
  }

  LoadIncrement follow_to(double target) {
    const int iterations_before = now_.iterations;
    LoadIncrement stop = make_increments(target);
    now_.iterations += path_.take_counts().iterations;
    now_.energy = path_.result().value;
    now_.gradient_norm = path_.result().gradient_norm;
    now_.termination = path_.result().stop;
    if (now_.termination == Termination::step_too_small && leave_jam_at_position()) ++stop.jumps;
    stop.energy = now_.energy;
    stop.gradient_norm = now_.gradient_norm;
    stop.iterations = now_.iterations - iterations_before;
    stop.stopped = relaxation_termination(now_.termination);
    return stop;
  }

  /// Follows the equilibrium in load increments that adapt, and counts them and the losses of an equilibrium.
  LoadIncrement make_increments(double target) {
    LoadIncrement counts;
    while (scene_.load() < target) {
      context_.execution.cancellation.throw_if_requested();
      const Path::Snapshot before = path_.snapshot();
      const double increment = std::min(max_increment_, target - scene_.load());
      scene_.set_target(increment < target - scene_.load() ? scene_.load() + increment : target);
      scene_.begin_step();
      const bool is_valid = scene_.predict(1);
      if (is_valid) path_.find_equilibrium();
      const bool is_unfinished = !is_valid || path_.result().stop == Termination::iteration_limit;
      const double loss =
          !is_unfinished && scene_.is_doubtful(path_.result().value) ? scene_.loss_on_return(quiet_options()) : 0;
      const bool is_lost = is_unfinished || loss > same_equilibrium;
      const double shortest = is_unfinished ? min_unfinished_increment : min_surface_increment;
      if ((is_unfinished || loss > near_equilibrium) && increment > shortest) {
        path_.restore(before);
        max_increment_ = std::max(shortest, increment / 2);
        continue;
      }
      if (is_unfinished) {
        // The surface does not wait for the network: the answer is the best state at the next position.
        scene_.place(target, before.state.points, before.state.cut_loci);
        path_.find_equilibrium();
      }
      ++counts.load_steps;
      counts.jumps += is_lost ? 1 : 0;
      if (!is_lost && path_.result().iterations <= quick_iterations) max_increment_ = std::min(1.0, 2 * increment);
    }
    return counts;
  }

  numerics::MinimizerOptions quiet_options() const {
    numerics::MinimizerOptions options = minimizer_;
    options.max_iterations = context_.options.max_iterations;
    return options;
  }

  /// Leaves a jam at the present position of the surface. Returns whether an equilibrium was lost by it.
  bool leave_jam_at_position() {
    const Equilibrium jammed = now_;
    take_scene();
    const SearchSettings settings{.max_iterations = now_.iterations + context_.options.max_iterations};
    now_ = leave_jam(context_, std::move(now_), settings, history_, execution_);
    const bool is_lower = now_.energy < jammed.energy - min_loss * jammed.energy;
    if (is_lower || now_.termination == Termination::converged) {
      scene_.place(scene_.load(), now_.state.points(), now_.state.cut_loci());
      return is_lower;
    }
    now_.energy = jammed.energy;
    now_.gradient_norm = jammed.gradient_norm;
    now_.termination = Termination::step_too_small;
    return false;
  }

  /// Makes the scene's state and surface the present ones.
  void take_scene() {
    now_.state = scene_.prepared_state();
    now_.moved_surface = scene_.solver();
  }

  const RelaxationContext& context_;
  const MovingHost& host_;
  RelaxationHistory& history_;
  const Execution& execution_;
  numerics::MinimizerOptions minimizer_;
  Equilibrium now_;
  MovingNetwork scene_;
  Path path_;
  double max_increment_ = 1;
};

}  // namespace

FollowedEquilibrium follow_surface(const RelaxationContext& context, Equilibrium start, const MovingHost& host,
                                   RelaxationHistory& history, const Execution& execution,
                                   const OnPosition& on_position) {
  return SurfaceFollower(context, std::move(start), host, history, execution).run(on_position);
}

}  // namespace supple::embedded
