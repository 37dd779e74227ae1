#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>

#include "geodesic_elements.h"
#include "point_damping.h"
#include "relaxation_run.h"

namespace supple::embedded {
namespace {

/// Load steps are lengths of the way from one position to the next, which is 1. Where an equilibrium is lost, shorter
/// steps of a surface than this do not find a nearer one; and where one search is too long, searches after shorter
/// steps than this are, too.
constexpr double shortest_surface_step = 1.0 / 64;
constexpr double shortest_unfinished_step = 1.0 / 8;
/// Shares of the energy by which that of an equilibrium differs on the way back if it is the same, and if it is so near
/// that shorter steps would hardly find a nearer one.
constexpr double same_equilibrium = 1e-7;
constexpr double near_equilibrium = 1e-2;
/// A load step of so few iterations lets the next one be twice as long.
constexpr int quick_surface_iterations = 6;
/// From a tangent, Newton's method finds the same equilibrium unless it is farther from the prediction than this share
/// of the way that was predicted. Then it may have found another one.
constexpr double doubtful_miss = 0.4;
/// The same for vertices of a host that are moved. Shorter steps help where elements are about to be turned inside out,
/// and not where an equilibrium is lost.
constexpr double shortest_support_step = 1.0 / 8;
constexpr double shortest_valid_step = 1.0 / 1024;
/// From a tangent a load step takes few iterations. Where a thin shell buckles on it, it takes some dozens, and shorter
/// ones do not find the way sooner.
constexpr int iterations_of_support_step = 80;
/// Less than this share of the energy is no loss: rounding and the tolerance of the gradient leave about as much.
constexpr double smallest_loss = 1e-9;

}  // namespace

RelaxationRun::Stop RelaxationRun::follow(const MovingHost& host, const Execution& execution) {
  const auto damping = std::make_shared<PointDamping>(points_.stiffness);
  MovingNetwork scene(solver_, network_, points_.held, damping, {.kept_strips = keeps_strips()}, host,
                      result_.gradient_tolerance, execution_);
  scene.place(0, state_.points(), state_.cut_loci());
  numerics::PathOptions options;
  options.minimizer = minimizer_options();
  options.minimizer.after_step = [&](const numerics::MinimizerStep& step) {
    if (step.step_length > 0) tell(step, scene.system().state());
  };
  options.max_iterations = options_.max_iterations;
  options.leave_unstable = false;
  SurfacePath path(scene, options, execution);
  Stop stop = Stop::converged;
  double step = 1;
  for (std::size_t k = 1; k <= host.positions.size(); ++k) {
    execution.checkpoint(static_cast<double>(k - 1) / static_cast<double>(host.positions.size()), "step");
    const int iterations = result_.iterations;
    FollowCounts counts = follow_surface(path, scene, static_cast<double>(k), step);
    result_.iterations += path.take_counts().iterations;
    result_.energy = path.result().value;
    result_.gradient_norm = path.result().gradient_norm;
    stop = path.result().stop;
    if (stop == Stop::step_too_small) stop = leave_jam_of(scene, counts.jumps, execution);
    result_.stops.push_back({.energy = result_.energy,
                             .gradient_norm = result_.gradient_norm,
                             .iterations = result_.iterations - iterations,
                             .load_steps = counts.load_steps,
                             .jumps = counts.jumps,
                             .stopped = std::string(numerics::to_string(stop))});
  }
  adopt(scene);
  describe_energies({scene.elements()});
  return stop;
}

RelaxationRun::FollowCounts RelaxationRun::follow_surface(SurfacePath& path, MovingNetwork& scene, double target,
                                                          double& step) {
  FollowCounts counts;
  while (scene.load() < target) {
    execution_.cancellation.throw_if_requested();
    const SurfacePath::Snapshot before = path.snapshot();
    const double made = std::min(step, target - scene.load());
    scene.announce(made < target - scene.load() ? scene.load() + made : target);
    scene.begin_step();
    const bool is_valid = scene.predict(1);
    if (is_valid) path.settle();
    const bool is_unfinished = !is_valid || path.result().stop == Stop::iteration_limit;
    const double loss =
        !is_unfinished && scene.is_doubtful(path.result().value) ? scene.loss_on_way_back(quiet_options()) : 0;
    const bool is_lost = is_unfinished || loss > same_equilibrium;
    const double shortest = is_unfinished ? shortest_unfinished_step : shortest_surface_step;
    if ((is_unfinished || loss > near_equilibrium) && made > shortest) {
      path.restore(before);
      step = std::max(shortest, made / 2);
      continue;
    }
    if (is_unfinished) {
      // The surface takes no notice: the best state at its next position is the answer there.
      scene.place(target, before.state.points, before.state.cut_loci);
      path.settle();
    }
    ++counts.load_steps;
    counts.jumps += is_lost ? 1 : 0;
    if (!is_lost && path.result().iterations <= quick_surface_iterations) step = std::min(1.0, 2 * made);
  }
  return counts;
}

numerics::MinimizerOptions RelaxationRun::quiet_options() const {
  numerics::MinimizerOptions options = minimizer_options();
  options.gradient_tolerance = result_.gradient_tolerance;
  options.max_iterations = options_.max_iterations;
  return options;
}

RelaxationRun::Stop RelaxationRun::leave_jam_of(MovingNetwork& scene, int& jumps, const Execution& execution) {
  const double before = result_.energy;
  const double gradient_before = result_.gradient_norm;
  iteration_limit_ = result_.iterations + options_.max_iterations;
  adopt(scene);
  const Stop stop = leave_jam(false, execution);
  const bool is_lower = result_.energy < before - smallest_loss * before;
  if (is_lower || stop == Stop::converged) {
    jumps += is_lower ? 1 : 0;
    scene.place(scene.load(), state_.points(), state_.cut_loci());
    return stop;
  }
  result_.energy = before;
  result_.gradient_norm = gradient_before;
  return Stop::step_too_small;
}

void RelaxationRun::adopt(MovingNetwork& scene) {
  scene.system().evaluate(0);
  moved_ = scene.shared_solver();
  state_ = scene.network_state();
}

RelaxationRun::Stop RelaxationRun::move_supports(Stop start, const Execution& execution) {
  Terms energies = host_.terms();
  energies.push_back(make_term(false, points_.held));
  Terms terms = energies;
  terms.insert(terms.end() - 1, std::make_shared<PointDamping>(points_.stiffness));
  numerics::System<NetworkState> system(state_, terms, numerics::Unknowns(held(points_.held)),
                                        {.execution = execution_});
  MovedSupports scene(system, host_, result_.gradient_tolerance);
  numerics::PathOptions options;
  options.minimizer = minimizer_options();
  options.minimizer.after_step = [&](const numerics::MinimizerStep& step) {
    if (step.step_length > 0 && !scene.is_on_trial()) tell(step, system.state());
  };
  options.max_iterations = std::min(options_.max_iterations, iterations_of_support_step);
  options.smallest_step = shortest_support_step;
  SupportPath path(scene, options, execution);
  Stop stop = start;
  int all_steps = 0;
  for (std::size_t k = 1; k <= scene.stops() && (k == 1 || result_.stops.back().reached == 1); ++k) {
    const auto target = static_cast<double>(k);
    scene.announce(target);
    const FollowCounts counts = follow_supports(path, scene, target, stop, execution);
    const int iterations = path.take_counts().iterations;
    stop = counts.stop;
    if (scene.load() < target)
      stop = path.stopped() == numerics::PathStop::iteration_limit ? Stop::iteration_limit : Stop::step_too_small;
    const numerics::Evaluation end = system.evaluate(1);
    result_.stops.push_back({.energy = end.value,
                             .gradient_norm = end.gradient.norm(),
                             .iterations = iterations,
                             .load_steps = std::max(1, counts.load_steps),
                             .jumps = counts.jumps,
                             .stopped = std::string(numerics::to_string(stop)),
                             .reached = scene.load() - (target - 1)});
    result_.iterations += iterations;
    all_steps += counts.load_steps;
  }
  result_.energy = result_.stops.back().energy;
  result_.gradient_norm = result_.stops.back().gradient_norm;
  if (execution_.cost)
    execution_.cost->add_effect("moved_vertices", true, "the host has vertices that are moved", all_steps);
  state_ = system.state();
  describe_energies(energies);
  return stop;
}

RelaxationRun::FollowCounts RelaxationRun::follow_supports(SupportPath& path, MovedSupports& scene, double target,
                                                           Stop start, const Execution& execution) {
  FollowCounts counts{.stop = start};
  double longest = 1;
  while (scene.load() < target) {
    execution.checkpoint(scene.load() / static_cast<double>(scene.stops()), "step");
    const bool at_kink = counts.stop != Stop::converged;
    scene.set_at_kink(at_kink);
    if (at_kink && scene.carry_rigidly()) {
      ++counts.load_steps;
      continue;
    }
    const SupportPath::Snapshot before = path.snapshot();
    const double energy_before = scene.objective().evaluate(0).value;
    const bool failed = at_kink || path.step(target - scene.load()) == SupportPath::Progress::failed;
    if (failed) {
      const bool blocked = at_kink || path.stopped() == numerics::PathStop::step_too_small;
      scene.set_at_kink(blocked);
      if (!go_on_without_equilibrium(path, scene, target, blocked ? longest : shortest_support_step)) break;
    }
    const double energy = path.result().value;
    const bool is_doubtful = !failed && scene.missed_share() > doubtful_miss;
    const bool is_lost = scene.has_jumped(energy) ||
                         (is_doubtful && comes_back_elsewhere(path, scene, before.state.load, energy_before));
    const double made = scene.load() - before.state.load;
    if (is_lost && made > shortest_support_step) {
      path.restore(before);
      longest = made / 2;
      path.set_largest_step(longest);
      continue;
    }
    counts.stop = path.result().stop;
    ++counts.load_steps;
    counts.jumps += is_lost ? 1 : 0;
    if (longest < 1) {
      longest = std::min(1.0, 2 * longest);
      path.set_largest_step(longest);
    }
  }
  return counts;
}

bool RelaxationRun::comes_back_elsewhere(SupportPath& path, MovedSupports& scene, double load, double energy) {
  const SupportPath::Snapshot there = path.snapshot();
  const SupportPath::Counts counts = path.counts();
  const double announced = scene.announced();
  scene.set_on_trial(true);
  scene.announce(load);
  scene.begin_step();
  const bool is_found = scene.predict(1) && path.settle();
  const double back = path.result().value;
  scene.set_on_trial(false);
  scene.announce(announced);
  path.restore(there);
  path.set_counts(counts);
  return is_found && std::abs(back - energy) > same_equilibrium * std::max(std::abs(energy), std::abs(back));
}

bool RelaxationRun::go_on_without_equilibrium(SupportPath& path, MovedSupports& scene, double target, double longest) {
  scene.begin_step();
  double way = longest;
  while (way >= shortest_valid_step) {
    const bool valid = scene.predict(std::min(1.0, way / (target - scene.load())));
    way /= 2;
    if (!valid) continue;
    path.set_max_iterations(options_.max_iterations);
    path.settle();
    path.set_max_iterations(std::min(options_.max_iterations, iterations_of_support_step));
    return true;
  }
  scene.restart_step();
  return false;
}

}  // namespace supple::embedded
