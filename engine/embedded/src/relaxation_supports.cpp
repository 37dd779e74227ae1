// How a network and its deformable host follow vertices that are moved to given positions.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>

#include "moved_supports.h"
#include "point_damping.h"
#include "relaxation_phases.h"

namespace supple::embedded {
namespace {

using Termination = numerics::MinimizerTermination;

/// Lengths of load increments; the way from one position to the next has the length 1. Where an equilibrium is lost,
/// shorter increments than the first do not help. They do help, down to the second, where elements are about to be
/// turned inside out.
constexpr double min_support_increment = 1.0 / 8;
constexpr double min_valid_increment = 1.0 / 1024;
/// A load increment takes few iterations from its prediction, and some dozens where a thin shell buckles. A shorter
/// increment would not end sooner then.
constexpr int max_iterations_of_increment = 80;
/// From a tangent, Newton's method finds the continuation of the same equilibrium, unless that is farther from the
/// prediction than this fraction of the predicted distance. Then it may be another one.
constexpr double max_prediction_error = 0.4;

class SupportFollower {
 public:
  SupportFollower(const RelaxationContext& context, Equilibrium start, RelaxationHistory& history,
                  const Execution& execution)
      : context_(context),
        history_(history),
        execution_(execution),
        minimizer_(context.minimizer_options()),
        now_(std::move(start)),
        system_(make_system()),
        scene_(*system_, context.host, minimizer_.gradient_tolerance),
        path_(scene_, path_options(), execution_) {}

  FollowedEquilibrium run(const OnPosition& on_position) {
    std::vector<LoadIncrement> stops;
    bill(0);
    const std::size_t count = scene_.position_count();
    for (std::size_t k = 1; k <= count && (k == 1 || stops.back().reached == 1); ++k) {
      int increments = 0;
      stops.push_back(follow_to(static_cast<double>(k), increments));
      bill(increments);
      now_.state = system_->prepared_state();
      on_position(now_, stops);
    }
    return {std::move(now_), std::move(stops)};
  }

 private:
  using System = numerics::System<NetworkState>;
  using Path = numerics::EquilibriumPath<MovedSupports>;

  void bill(int increments) const {
    if (context_.execution.cost)
      context_.execution.cost->add_effect("moved_vertices", true, "the host has vertices that are moved", increments);
  }

  std::unique_ptr<System> make_system() const {
    const NetworkTerm term = network_term(context_.solver, context_.elements, context_.search_options(false));
    System::Terms terms = context_.host.terms();
    terms.push_back(std::make_shared<PointDamping>(context_.points.stiffness));
    terms.push_back(term.energy);
    return std::make_unique<System>(now_.state, std::move(terms),
                                    numerics::Unknowns(context_.fixed_degrees(context_.points.fixed)),
                                    numerics::SystemOptions{.execution = context_.execution}, term.search);
  }

  numerics::PathOptions path_options() {
    numerics::PathOptions options;
    options.minimizer = minimizer_;
    options.minimizer.after_step = [this](const numerics::MinimizerStep& step) {
      if (step.step_length > 0 && !scene_.is_on_trial()) history_.record(step, system_->state());
    };
    options.max_iterations = max_iterations();
    options.smallest_step = min_support_increment;
    return options;
  }
  int max_iterations() const { return std::min(context_.options.max_iterations, max_iterations_of_increment); }

  LoadIncrement follow_to(double target, int& all_increments) {
    scene_.set_target(target);
    LoadIncrement stop = make_increments(target);
    all_increments += stop.load_steps;
    stop.load_steps = std::max(1, stop.load_steps);
    stop.iterations = path_.take_counts().iterations;
    if (scene_.load() < target)
      now_.termination = path_.stopped() == numerics::PathTermination::iteration_limit ? Termination::iteration_limit
                                                                                       : Termination::step_too_small;
    const numerics::Evaluation end = system_->evaluate(1);
    now_.energy = stop.energy = end.value;
    now_.gradient_norm = stop.gradient_norm = end.gradient.norm();
    now_.iterations += stop.iterations;
    stop.stopped = relaxation_termination(now_.termination);
    stop.reached = scene_.load() - (target - 1);
    return stop;
  }

  /// Follows the equilibrium in load increments that adapt, and counts them and the losses of an equilibrium.
  LoadIncrement make_increments(double target) {
    LoadIncrement counts;
    double max_increment = 1;
    while (scene_.load() < target) {
      execution_.checkpoint(scene_.load() / static_cast<double>(scene_.position_count()), "step");
      const bool at_kink = now_.termination != Termination::converged;
      scene_.set_at_kink(at_kink);
      if (at_kink && scene_.move_rigidly()) {
        ++counts.load_steps;
        continue;
      }
      const Path::Snapshot before = path_.snapshot();
      const double energy_before = scene_.objective().evaluate(0).value;
      const bool failed = at_kink || path_.step(target - scene_.load()) == Path::Progress::failed;
      if (failed) {
        const bool is_blocked = at_kink || path_.stopped() == numerics::PathTermination::step_too_small;
        scene_.set_at_kink(is_blocked);
        if (!advance_without_equilibrium(target, is_blocked ? max_increment : min_support_increment)) break;
      }
      const bool is_doubtful = !failed && scene_.prediction_error() > max_prediction_error;
      const bool is_lost = scene_.has_jumped(path_.result().value) ||
                           (is_doubtful && returns_elsewhere(before.state.load, energy_before));
      const double increment = scene_.load() - before.state.load;
      if (is_lost && increment > min_support_increment) {
        path_.restore(before);
        max_increment = increment / 2;
        path_.set_largest_step(max_increment);
        continue;
      }
      now_.termination = path_.result().stop;
      ++counts.load_steps;
      counts.jumps += is_lost ? 1 : 0;
      if (max_increment < 1) {
        max_increment = std::min(1.0, 2 * max_increment);
        path_.set_largest_step(max_increment);
      }
    }
    return counts;
  }

  /// Whether the way back from the present equilibrium to an earlier load ends at another energy than the equilibrium
  /// had there.
  bool returns_elsewhere(double load, double energy) {
    const Path::Snapshot here = path_.snapshot();
    const Path::Counts counts = path_.counts();
    const double target = scene_.target();
    scene_.set_on_trial(true);
    scene_.set_target(load);
    scene_.begin_step();
    const bool is_found = scene_.predict(1) && path_.find_equilibrium();
    const double energy_there = path_.result().value;
    scene_.set_on_trial(false);
    scene_.set_target(target);
    path_.restore(here);
    path_.set_counts(counts);
    return is_found &&
           std::abs(energy_there - energy) > same_equilibrium * std::max(std::abs(energy), std::abs(energy_there));
  }

  /// Where no increment finds an equilibrium although no element is turned inside out, takes the best state after an
  /// increment of at most this length. Returns false where there is none.
  bool advance_without_equilibrium(double target, double max_increment) {
    scene_.begin_step();
    double increment = max_increment;
    while (increment >= min_valid_increment) {
      const bool is_valid = scene_.predict(std::min(1.0, increment / (target - scene_.load())));
      increment /= 2;
      if (!is_valid) continue;
      path_.set_max_iterations(context_.options.max_iterations);
      path_.find_equilibrium();
      path_.set_max_iterations(max_iterations());
      return true;
    }
    scene_.restart_step();
    return false;
  }

  const RelaxationContext& context_;
  RelaxationHistory& history_;
  const Execution& execution_;
  numerics::MinimizerOptions minimizer_;
  Equilibrium now_;
  std::unique_ptr<System> system_;
  MovedSupports scene_;
  Path path_;
};

}  // namespace

FollowedEquilibrium follow_supports(const RelaxationContext& context, Equilibrium start, RelaxationHistory& history,
                                    const Execution& execution, const OnPosition& on_position) {
  return SupportFollower(context, std::move(start), history, execution).run(on_position);
}

}  // namespace supple::embedded
