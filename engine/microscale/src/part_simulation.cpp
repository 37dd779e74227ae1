#include "supple/microscale/part_simulation.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "part_scene.h"
#include "path_limits.h"
#include "supple/base/number_text.h"
#include "supple/microscale/part_strain.h"
#include "supple/microscale/simulation_error.h"
#include "support_states.h"

namespace supple::microscale {
namespace {

using Path = numerics::EquilibriumPath<PartScene>;

/// A motion of a support below this fraction of the part's length is not divided again.
constexpr double min_support_motion = 1e-6;
/// The curvature of the energy along the buckling of a beam is about 1e-8 of the Hessian's scale, and less for a part
/// of many beams. The first regularization that is tried, relative to that scale, is therefore well below.
constexpr double min_part_regularization = 1e-12;
/// Repetitions of a minimization, in each of which nodes of plates are held or released.
constexpr int max_repeats = 60;

constexpr int max_part_states = 1000;
constexpr double max_thickness = 1000;  // mm

void check(const PartSimulationOptions& options) {
  std::vector<Error::Detail> details;
  const auto require = [&](bool holds, const char* where, const std::string& message, double value) {
    if (!holds) details.push_back({where, message + ", but is " + number_text(value)});
  };
  const Material& material = options.material;
  require(material.youngs_modulus > 0 && std::isfinite(material.youngs_modulus), "material/youngs_modulus",
          "must be a positive number", material.youngs_modulus);
  if (material.law == Law::neo_hookean)
    require(material.poisson_ratio > -1 && material.poisson_ratio < 0.4999, "material/poisson_ratio",
            "must lie between -1 and 0.4999", material.poisson_ratio);
  require(options.thickness > 0 && options.thickness <= max_thickness, "thickness",
          "must be positive and at most " + number_text(max_thickness) + " mm", options.thickness);
  require(options.states >= 1 && options.states <= max_part_states, "states",
          "must lie between 1 and " + std::to_string(max_part_states), options.states);
  require(options.tolerance > 0 && options.tolerance < 1, "tolerance", "must lie between 0 and 1", options.tolerance);
  require(options.max_iterations >= 1, "max_iterations", "must be at least 1", options.max_iterations);
  require(options.max_load_step > 0, "max_load_step", "must be positive", options.max_load_step);
  require(options.pressure_length > 0 && std::isfinite(options.pressure_length), "pressure_length",
          "must be a positive number", options.pressure_length);
  if (details.empty()) return;
  throw SimulationError("simulation.invalid_option",
                        "Option " + details.front().where + " " + details.front().message + ".", details);
}

numerics::PathOptions path_options(const PartSimulationOptions& simulation, const PartSupports& supports) {
  numerics::PathOptions options;
  options.minimizer.reuse_contraction = reuse_contraction;
  options.minimizer.first_regularization = min_part_regularization;
  options.minimizer.max_expansion = max_expansion;
  options.max_iterations = simulation.max_iterations;
  options.max_repeats = max_repeats;
  const double motion = std::max(supports.largest_motion(), min_support_motion);
  options.largest_step = std::min(1.0, simulation.max_load_step / motion);
  options.smallest_step = std::min(1e-2, min_support_motion / motion);
  options.leave_unstable = simulation.buckling != Switch::off;
  // Beams can be so soft in bending, compared with elements, that a curvature of 1e-13 of the matrix's scale may be
  // theirs.
  options.curvature_tolerance = 0;
  return options;
}

PartStop stop_of(const Path& path, const PartScene& scene) {
  if (scene.lost_support()) return PartStop::lost_support;
  return path.stopped() == numerics::PathTermination::iteration_limit ? PartStop::iteration_limit
                                                                      : PartStop::step_too_small;
}

std::string message_of(PartStop stop, double fraction) {
  const std::string where = "The path ended at the fraction " + number_text(fraction) + " of the displacements: ";
  switch (stop) {
    case PartStop::converged:
      break;
    case PartStop::iteration_limit:
      return where + "the smallest load step did not converge.";
    case PartStop::step_too_small:
      return where + "no step lowers the energy, because an element or a contact is at its limit.";
    case PartStop::lost_support:
      return where + "beyond it, the part touches too few supports and could move as a rigid body.";
  }
  return {};
}

PartState state_of(const PartScene& scene, const Path& path, const PartSupports& supports,
                   const tiling::PeriodicMesh& mesh, const PartSimulationOptions& options) {
  PartState state;
  state.fraction = scene.fraction();
  state.residual = scene.at().residual;
  state.supports = support_states(supports, scene.constraints(), scene.x(), scene.at().gradient, scene.fraction(),
                                  options.thickness, options.pressure_length);
  state.energy = options.thickness * scene.at().energy;
  state.stable = path.stable();
  state.contacts = scene.contacts();
  const Eigen::Map<const Eigen::Matrix2Xd> displacements(scene.x().data(), 2, mesh.nodes.cols());
  state.largest_strain = largest_strain(mesh, displacements);
  if (options.deformed_nodes) state.displacements = displacements;
  return state;
}

/// Bills the effects that neither a term nor the path has billed, with the reason why they did not run.
void bill_effects_that_did_not_run(const PartSimulationOptions& options, CostLedger* cost) {
  if (!cost) return;
  const auto bill = [cost](std::string_view name, Switch wanted, std::string_view why) {
    const auto& effects = cost->effects();
    if (std::ranges::any_of(effects, [name](const CostLedger::Effect& e) { return e.name == name && e.ran; })) return;
    cost->add_effect(name, false, wanted == Switch::off ? "switched off by the request" : why);
  };
  bill("contact", options.contact, "no pair of boundary points came within the barrier's range");
  bill("buckling", options.buckling, "the stiffness stayed positive definite");
}

}  // namespace

std::string_view to_string(Side side) {
  switch (side) {
    case Side::bottom:
      return "bottom";
    case Side::top:
      return "top";
    case Side::left:
      return "left";
    case Side::right:
      break;
  }
  return "right";
}

std::string_view to_string(PartStop stop) {
  switch (stop) {
    case PartStop::converged:
      return "converged";
    case PartStop::iteration_limit:
      return "iteration_limit";
    case PartStop::step_too_small:
      return "step_too_small";
    case PartStop::lost_support:
      break;
  }
  return "lost_support";
}

PartSimulationResult simulate_part(const tiling::PeriodicMesh& mesh, const std::vector<Support>& supports,
                                   const PartSimulationOptions& options, const Execution& execution,
                                   const std::function<void(const PartState&)>& on_state) {
  check(options);
  const PartSupports placed(mesh, supports);
  PartScene scene(mesh, placed, options, execution);
  Path path(scene, path_options(options, placed), {execution.cancellation, nullptr, execution.cost});
  PartSimulationResult result;
  result.nodes = static_cast<int>(mesh.nodes.cols());
  result.fixed_translation = placed.fixes_translation();
  int branch = 0;
  const auto add = [&](PartStop stopped) {
    PartState state = state_of(scene, path, placed, mesh, options);
    const Path::Counts counts = path.take_counts();
    branch += counts.branches_left;
    state.stopped = stopped;
    state.iterations = counts.iterations;
    state.load_steps = counts.load_steps;
    state.branch = branch;
    if (on_state) on_state(state);
    result.states.push_back(std::move(state));
    result.unknowns = std::max(result.unknowns, static_cast<int>(scene.objective().dimension()));
  };
  const auto end_early = [&] {
    const PartStop stopped = stop_of(path, scene);
    add(stopped);
    result.message = message_of(stopped, scene.fraction());
    bill_effects_that_did_not_run(options, execution.cost);
  };
  if (!path.find_equilibrium()) {
    end_early();
    return result;
  }
  for (int k = 1; k <= options.states; ++k) {
    const double target = static_cast<double>(k) / options.states;
    for (auto progress = Path::Progress::partial; progress != Path::Progress::complete;) {
      execution.checkpoint(scene.fraction(), "part simulation");
      progress = path.step(scene.set_target(target));
      if (progress != Path::Progress::failed) continue;
      end_early();
      return result;
    }
    add(PartStop::converged);
  }
  bill_effects_that_did_not_run(options, execution.cost);
  execution.checkpoint(1, "part simulation");
  return result;
}

}  // namespace supple::microscale
