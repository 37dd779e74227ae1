#include "supple/embedded/relaxation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "relaxation_phases.h"
#include "supple/base/best_so_far.h"
#include "supple/base/error.h"
#include "supple/base/number_text.h"
#include "supple/base/part_of_execution.h"

namespace supple::embedded {
namespace {

using Termination = numerics::MinimizerTermination;

/// Fraction of the progress at the first equilibrium, before a host moves.
constexpr double fraction_before_moving = 0.2;

void check_options(const RelaxationOptions& options) {
  const auto refuse = [](const std::string& field, const std::string& what) {
    throw Error("network.invalid_option", "An option of the relaxation is out of range.", {{field, what}});
  };
  if (!std::isfinite(options.tolerance) || options.tolerance < 0)
    refuse("accuracy/tolerance", "is " + number_text(options.tolerance) + ", but must be finite and not negative");
  if (options.max_iterations < 0)
    refuse("max_iterations", "is " + std::to_string(options.max_iterations) + ", but must not be negative");
  if (!(options.mollifier_length > 0 && options.mollifier_length <= 0.5))
    refuse("accuracy/mollifier_length",
           "is " + number_text(options.mollifier_length) + ", but must be above 0 and at most 0.5");
}

void check_host(const RelaxationOptions& options, const Network& network) {
  if (options.spring_length == SpringLength::euclidean && !network.triangles.empty())
    throw Error("network.invalid_option", "The sides of triangles are shortest paths: there are no straight ones.",
                {{"spring_length", "is \"euclidean\", which triangles do not have"}});
  if (std::holds_alternative<RigidHost>(options.host)) return;
  if (options.spring_length == SpringLength::euclidean)
    throw Error("network.invalid_option", "On a host that does not keep its shape springs follow shortest paths.",
                {{"spring_length", "is \"euclidean\", which only a rigid host has"}});
  if (options.mollifier == Switch::on)
    throw Error("network.invalid_option", "On a host that does not keep its shape paths are not mollified.",
                {{"effects/mollifier", "is \"on\", which only a rigid host has"}});
}

/// The equilibrium on the host at its first position.
Equilibrium rest_on_host(const RelaxationContext& context, bool is_mollified, RelaxationHistory& history,
                         const Execution& execution) {
  const SearchSettings settings{.is_mollified = is_mollified, .max_iterations = context.options.max_iterations};
  Equilibrium rest = find_equilibrium(context, start_of(context), settings, history, execution);
  if (rest.termination != Termination::step_too_small) return rest;
  return leave_jam(context, std::move(rest), settings, history, execution);
}

bool has_pinned_path(const NetworkState& state) {
  return state.found() && std::ranges::any_of(state.found()->geodesics, &surface::TangentGeodesic::pinned);
}

/// Whether the automatic mollifier is called for: only where the search without it ended before it converged, with a
/// path through a vertex.
bool needs_mollifier(const RelaxationContext& context, const Equilibrium& end) {
  return context.follows_geodesics() && context.is_rigid() && context.options.mollifier == Switch::automatic &&
         end.termination != Termination::converged && end.iterations < context.options.max_iterations &&
         has_pinned_path(end.state);
}

/// The equilibrium at the last position that a host has reached, and the size of the history by then.
struct ReachedPosition {
  FollowedEquilibrium found;
  std::size_t history_size = 0;
};

/// Says why a search was stopped before it was at rest, or on the way to the next position of a host.
void note_stop(StopReason reason, bool is_on_the_way, Relaxation& result) {
  result.stopped = reason == StopReason::deadline ? RelaxationTermination::deadline : RelaxationTermination::memory;
  const std::size_t position = result.stops.size();
  const std::string when =
      is_on_the_way
          ? " on the way to position " + std::to_string(position) + ": this is the equilibrium " +
                (position == 0 ? "before the first motion." : "at position " + std::to_string(position - 1) + ".")
          : " after " + std::to_string(result.iterations) + (result.iterations == 1 ? " iteration" : " iterations") +
                ": this is the best state until then, and the network is not at rest.";
  result.warnings.push_back(stop_sentence(reason, when));
}

Relaxation run_phases(const RelaxationContext& context) {
  const bool starts_mollified = context.follows_geodesics() && context.options.mollifier == Switch::on;
  const auto* moving = std::get_if<MovingHost>(&context.options.host);
  const bool moves = moving || !context.host.moved().empty();
  RelaxationHistory history(context.options);
  std::optional<FollowedEquilibrium> found;
  std::optional<ReachedPosition> reached;
  const OnPosition keep_position = [&](const Equilibrium& end, const std::vector<LoadIncrement>& stops) {
    ReachedPosition here{{end, stops}, history.size()};  // first, since memory may be refused for it
    reached = std::move(here);
  };
  std::size_t first_mollified = starts_mollified ? 0 : std::numeric_limits<std::size_t>::max();  // in the history
  const auto search = [&] {
    const PartOfExecution rest(context.execution, 0, moves ? fraction_before_moving : 1);
    found = FollowedEquilibrium{rest_on_host(context, starts_mollified, history, rest.execution()), {}};
    if (moves) {
      keep_position(found->end, {});
      history.keep_no_states();
      const PartOfExecution motion(context.execution, fraction_before_moving, 1 - fraction_before_moving);
      found = moving
                  ? follow_surface(context, std::move(found->end), *moving, history, motion.execution(), keep_position)
                  : follow_supports(context, std::move(found->end), history, motion.execution(), keep_position);
    }
    if (!needs_mollifier(context, found->end)) return;
    first_mollified = history.size();
    found->end =
        find_equilibrium(context, found->end, {.is_mollified = true, .max_iterations = context.options.max_iterations},
                         history, context.execution);
  };
  const StopReason reason = search_until_stopped(
      context.execution.cancellation, [&] { return reached || history.state(); }, search);
  if (reason != StopReason::none && reached) {
    history.truncate(reached->history_size);
    found = std::move(reached->found);
  } else if (reason != StopReason::none) {
    found = FollowedEquilibrium{best_of(context, history), {}};
  }
  const bool is_mollified = history.size() > first_mollified;
  Relaxation result = describe_relaxation(context, *found, is_mollified, std::move(history));
  if (reason != StopReason::none) note_stop(reason, reached.has_value(), result);
  return result;
}

}  // namespace

Relaxation relax(const surface::GeodesicSolver& solver, const Network& network, const RelaxationOptions& options,
                 const Execution& execution) {
  check_options(options);
  check_host(options, network);
  const Network checked = checked_network(solver.mesh(), network);
  execution.checkpoint(0, "search");
  Relaxation result = run_phases(RelaxationContext(solver, checked, options, execution));
  execution.checkpoint(1, "step");
  return result;
}

}  // namespace supple::embedded
