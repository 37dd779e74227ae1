#include "supple/embedded/relaxation.h"

#include <cmath>
#include <string>
#include <utility>
#include <variant>

#include "relaxation_run.h"
#include "supple/base/error.h"
#include "supple/base/part_of_execution.h"

namespace supple::embedded {
namespace {

/// Progress fraction of the first equilibrium, before a host moves.
constexpr double fraction_before_moving = 0.2;

void check_options(const RelaxationOptions& options) {
  const auto refuse = [](const std::string& field, const std::string& what) {
    throw Error("network.invalid_option", "An option of the relaxation is out of range.", {{field, what}});
  };
  if (!std::isfinite(options.tolerance) || options.tolerance < 0)
    refuse("accuracy/tolerance", "is " + std::to_string(options.tolerance) + ", but must be finite and not negative");
  if (options.max_iterations < 0)
    refuse("max_iterations", "is " + std::to_string(options.max_iterations) + ", but must not be negative");
  if (!(options.mollifier_length > 0 && options.mollifier_length <= 0.5))
    refuse("accuracy/mollifier_length",
           "is " + std::to_string(options.mollifier_length) + ", but must be above 0 and at most 0.5");
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

}  // namespace

RelaxationRun::RelaxationRun(const surface::GeodesicSolver& solver, const Network& network,
                             const RelaxationOptions& options, const Execution& execution)
    : solver_(solver),
      network_(network),
      options_(options),
      execution_(execution),
      points_(constrained_points(network)),
      host_(solver.mesh(), options.host, execution),
      state_(first_state()),
      iteration_limit_(options.max_iterations) {}

bool RelaxationRun::keeps_shape() const { return std::holds_alternative<RigidHost>(options_.host); }

const surface::GeodesicSolver& RelaxationRun::solver() const {
  if (moved_) return *moved_;
  return state_.surface() ? *state_.surface() : solver_;
}

Relaxation RelaxationRun::run() {
  const bool mollified = is_geodesic() && options_.mollifier == Switch::on;
  const auto* moving = std::get_if<MovingHost>(&options_.host);
  Stop stop = Stop::converged;
  {
    const PartOfExecution part(execution_, 0, moving || !host_.moved().empty() ? fraction_before_moving : 1);
    stop = minimize(mollified, part.execution());
    if (stop == Stop::step_too_small) stop = leave_jam(mollified, part.execution());
  }
  {
    const PartOfExecution part(execution_, fraction_before_moving, 1 - fraction_before_moving);
    if (moving) stop = follow(*moving, part.execution());
    if (!host_.moved().empty()) stop = move_supports(stop, part.execution());
  }
  if (is_geodesic() && keeps_shape() && options_.mollifier == Switch::automatic && stop != Stop::converged &&
      may_go_on() && some_path_is_pinned()) {
    result_.mollified = true;
    stop = minimize(true, execution_);
  }
  result_.mollified = result_.mollified || mollified;
  add_effects();
  describe(stop);
  return std::move(result_);
}

Relaxation relax(const surface::GeodesicSolver& solver, const Network& network, const RelaxationOptions& options,
                 const Execution& execution) {
  check_options(options);
  check_host(options, network);
  const Network own = checked_network(solver.mesh(), network);
  execution.checkpoint(0, "search");
  Relaxation result = RelaxationRun(solver, own, options, execution).run();
  execution.checkpoint(1, "step");
  return result;
}

}  // namespace supple::embedded
