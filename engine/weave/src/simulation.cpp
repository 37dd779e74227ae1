#include "supple/weave/simulation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>

#include "natural_units.h"
#include "resolution_error.h"
#include "supple/base/best_so_far.h"
#include "supple/base/faults.h"
#include "supple/base/number_text.h"
#include "supple/base/part_of_execution.h"
#include "supple/weave/weave_error.h"
#include "weave_run.h"

namespace supple::weave {
namespace {

constexpr int max_states = 10'000;

void check_place(const Weave& weave, int strand, double coordinate, const std::string& where, Faults& faults) {
  const bool known = strand >= 0 && strand < static_cast<int>(weave.strands.size());
  faults.require(known, where + "/strand", "names no strand");
  if (!known) return;
  const double length = weave.strands[static_cast<std::size_t>(strand)].curve.length();
  faults.require(coordinate >= 0 && coordinate <= length, where + "/coordinate",
                 "must lie within [0, " + number_text(length) + "] mm");
}

void check(const Weave& weave, const SheetLoad& load) {
  Faults faults;
  faults.require(!weave.lattice, "lattice", "is for periodic cells; a sheet has none");
  faults.require(!load.supports.empty(), "supports", "must not be empty: nothing would hold the sheet");
  faults.require(load.states >= 1 && load.states <= max_states, "states", "must lie within [1, 10000]");
  for (std::size_t i = 0; i < load.supports.size(); ++i) {
    const Support& support = load.supports[i];
    const std::string where = "supports/" + std::to_string(i);
    check_place(weave, support.strand, support.coordinate, where, faults);
    faults.require(support.displacement.allFinite() && support.rotation.allFinite(), where,
                   "moves by numbers that must be finite");
  }
  for (std::size_t i = 0; i < load.forces.size(); ++i) {
    const std::string where = "forces/" + std::to_string(i);
    check_place(weave, load.forces[i].strand, load.forces[i].coordinate, where, faults);
    faults.require(load.forces[i].force.allFinite(), where + "/force", "must be finite, in N");
  }
  faults.throw_if_any<InvalidLoad>("weave.invalid_load");
}

/// The load converted to these units.
SheetLoad in_natural_units(SheetLoad load, const NaturalUnits& units) {
  for (Support& support : load.supports) {
    support.coordinate /= units.length;
    support.displacement /= units.length;
  }
  for (PointForce& force : load.forces) {
    force.coordinate /= units.length;
    force.force /= units.force();
  }
  return load;
}

Prescription prescribe(const SheetLoad& load) {
  using Kind = Prescription::Entry::Kind;
  Prescription result;
  result.anchors.reserve(load.supports.size() + load.forces.size());
  for (const Support& support : load.supports) {
    const auto anchor = static_cast<int>(result.anchors.size());
    result.anchors.push_back({support.strand, support.coordinate, support.clamped});
    for (int c = 0; c < 3; ++c) {
      if (support.held[static_cast<std::size_t>(c)])
        result.fixed.push_back({Kind::position, anchor, c, support.displacement[c]});
      if (support.clamped) result.fixed.push_back({Kind::joint, anchor, c, support.rotation[c]});
    }
    result.leaves_plane = result.leaves_plane || (support.held[2] && support.displacement[2] != 0) ||
                          (support.clamped && !support.rotation.head<2>().isZero());
  }
  for (const PointForce& force : load.forces) {
    result.forces.push_back({static_cast<int>(result.anchors.size()), force.force});
    result.anchors.push_back({force.strand, force.coordinate, false});
    result.leaves_plane = result.leaves_plane || force.force[2] != 0;
  }
  return result;
}

/// Checks that each clamp has a joint, which a strand that slides through its crossing has not, and that no component
/// is fixed twice.
void check_nodes(const Weave& weave, const SheetLoad& load, const Prescription& prescription,
                 const EquilibriumOptions& options, const Execution& execution) {
  const RodModel model(
      weave, prescription.anchors,
      {.spatial = false, .segments = options.segments, .direction = 0, .cancellation = execution.cancellation});
  Faults faults;
  for (std::size_t i = 0; i < load.supports.size(); ++i)
    if (load.supports[i].clamped && model.anchor_joint(i) < 0)
      faults.add("supports/" + std::to_string(i) + "/clamped", "must be false where the strand slides");
  // Index of the first support that fixes a component of a node.
  std::unordered_map<int, std::array<std::optional<std::size_t>, 3>> holders;
  for (std::size_t i = 0; i < load.supports.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      if (!load.supports[i].held[c]) continue;
      auto& holder = holders[model.anchor_node(i)][c];
      if (holder)
        faults.add("supports/" + std::to_string(i),
                   "holds what supports/" + std::to_string(*holder) + " holds already");
      else
        holder = i;
    }
  }
  faults.throw_if_any<InvalidLoad>("weave.invalid_load");
}

/// The strain of a load: the largest displacement over the layout's extent, or rotation over half a turn.
double strain_of(const SheetLoad& load, const Weave& weave) {
  Eigen::AlignedBox2d box;
  for (const Strand& strand : weave.strands)
    for (const double s : strand.curve.point_coordinates()) box.extend(strand.curve.at(s).position);
  double strain = 0;
  for (const Support& support : load.supports)
    strain = std::max(
        {strain, support.displacement.norm() / box.diagonal().norm(), support.rotation.norm() / std::numbers::pi});
  return strain;
}

/// The reported state of a run. Its sheet and `load` are in these units.
SheetState state_of(WeaveRun& run, const SheetLoad& load, const NaturalUnits& units) {
  const LimitedState& reported = run.reported();
  const RodModel& model = run.model();
  const int dimension = model.dimension();
  SheetState state;
  const Eigen::VectorXd& q = reported.q;
  state.share = run.fraction();
  state.energy = units.energy() * reported.energy;
  state.strands = polylines(model, q, units.length);
  state.crossings.reserve(model.weave().crossings.size());
  for (int c = 0; c < static_cast<int>(model.weave().crossings.size()); ++c) {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    position.head(dimension) = units.length * q.segment(model.position(model.crossing_node(c)), dimension);
    state.crossings.push_back(position);
  }
  state.sliding.reserve(model.sliders().size());
  for (int i = 0; i < static_cast<int>(model.sliders().size()); ++i)
    state.sliding.push_back(units.length * q[model.slider(i)]);
  state.reactions.reserve(load.supports.size());
  for (std::size_t i = 0; i < load.supports.size(); ++i) {
    Eigen::Vector3d reaction = Eigen::Vector3d::Zero();
    for (int c = 0; c < dimension; ++c)
      if (load.supports[i].held[static_cast<std::size_t>(c)])
        reaction[c] = units.force() * reported.gradient[model.position(model.anchor_node(i)) + c];
    state.reactions.push_back(reaction);
  }
  state.out_of_plane = run.spatial();
  state.stable = reported.stable;
  state.stopped = run.path().termination();
  state.residual = units.force() * reported.residual;
  state.tolerance = units.force() * run.path().tolerance();
  state.limit_error = reported.limit_error;
  return state;
}

/// Follows the path from state to state, to its end or as far as it goes.
void follow(WeaveRun& run, const SheetLoad& load, const NaturalUnits& units, const Execution& execution,
            SimulationResult& result) {
  int iterations = 0;
  int load_steps = 0;
  int branches = 0;
  for (int k = 1; k <= load.states; ++k) {
    execution.checkpoint(static_cast<double>(k - 1) / load.states, "states");
    const bool arrived = run.advance_to(k == load.states ? 1 : static_cast<double>(k) / load.states);
    SheetState state = state_of(run, load, units);
    if (!arrived && state.stopped == Stop::converged) state.stopped = Stop::step_too_small;
    state.iterations = run.iterations() - std::exchange(iterations, run.iterations());
    state.load_steps = run.load_steps() - std::exchange(load_steps, run.load_steps());
    state.branches = run.branches() - std::exchange(branches, run.branches());
    result.unknowns = std::max(result.unknowns, static_cast<int>(run.objective().dimension()));
    result.states.push_back(std::move(state));
    if (arrived) continue;
    result.message = "The path could not be followed beyond " + number_text(run.fraction()) +
                     " of the loads: the load step was halved down to its limit without convergence (" +
                     std::string(to_string(result.states.back().stopped)) + ").";
    return;
  }
}

/// Says of the last state, which is an equilibrium, that there was no time or memory for the next one.
void note_stop(StopReason reason, SimulationResult& result) {
  SheetState& last = result.states.back();
  last.stopped = reason == StopReason::deadline ? Stop::deadline : Stop::memory;
  result.message = stop_sentence(reason, " after the equilibrium under " + number_text(last.share) +
                                             " of the loads: the path was not followed further.");
}

/// A load, checked and in the natural units of its sheet.
struct ScaledLoad {
  SheetLoad load;
  Prescription prescription;
};

/// Follows the load path of a sheet.
SimulationResult follow(const NaturalWeave& natural, const ScaledLoad& scaled, const EquilibriumOptions& options,
                        const Execution& execution) {
  const SheetLoad& load = scaled.load;
  WeaveRun run(natural.weave(), scaled.prescription, 0, in_natural_units(options, natural.units()), execution);
  SimulationResult result;
  result.states.reserve(static_cast<std::size_t>(load.states));
  const StopReason stop = search_until_stopped(
      execution.cancellation, [&] { return !result.states.empty(); },
      [&] { follow(run, load, natural.units(), execution, result); });
  if (stop != StopReason::none) note_stop(stop, result);
  run.bill_effects();
  return result;
}

/// Sets the errors of the states, from those of another resolution, of which there may be fewer. The last state before
/// time or memory ran out is an equilibrium, too. Returns the number of states that were compared.
std::size_t set_errors(const SimulationResult& other, double factor, SimulationResult& result) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < std::min(result.states.size(), other.states.size()); ++k) {
    SheetState& state = result.states[k];
    const SheetState& compared = other.states[k];
    const bool is_known = compared.stopped == Stop::converged || is_cut_short(compared.stopped);
    if (state.stopped != Stop::converged || !is_known) continue;
    ++count;
    state.energy_error = factor * std::abs(state.energy - compared.energy) + state.limit_error * state.energy;
    double largest = 0;
    double difference = 0;
    for (std::size_t i = 0; i < state.reactions.size(); ++i) {
      largest = std::max(largest, state.reactions[i].norm());
      difference = std::max(difference, (state.reactions[i] - compared.reactions[i]).norm());
    }
    state.reaction_error = factor * difference + state.limit_error * largest;
  }
  return count;
}

/// Estimates the errors of the states by following the path once more with rods of another resolution.
void estimate_errors(const NaturalWeave& natural, const ScaledLoad& scaled, const EquilibriumOptions& options,
                     const Execution& execution, SimulationResult& result) {
  const EstimateTimer timer(execution.cost);
  const OtherResolution other = other_resolution(options);
  const std::size_t count =
      set_errors(follow(natural, scaled, other.equilibrium, {execution.cancellation, execution.progress, nullptr}),
                 other.factor, result);
  timer.bill(
      {.count = count, .total = result.states.size(), .entries = "states", .segments = other.equilibrium.segments});
}

}  // namespace

SimulationResult simulate(const Weave& weave, const SheetLoad& load, const EquilibriumOptions& options,
                          const Execution& execution) {
  validate(weave, execution);
  validate(options);
  check(weave, load);
  execution.cancellation.throw_if_requested();
  const NaturalWeave natural(weave);
  ScaledLoad scaled{in_natural_units(load, natural.units()), {}};
  scaled.prescription = prescribe(scaled.load);
  scaled.prescription.strain = strain_of(scaled.load, natural.weave());
  check_nodes(natural.weave(), scaled.load, scaled.prescription, options, execution);
  if (options.error_estimate != Switch::on) {
    bill_no_estimate(options.error_estimate, execution.cost);
    return follow(natural, scaled, options, execution);
  }
  constexpr double fraction = 0.7;  // of the progress, until errors are estimated
  const PartOfExecution first(execution, 0, fraction);
  SimulationResult result = follow(natural, scaled, options, first.execution());
  if (is_cut_short(result.states.back().stopped)) {
    bill_estimate_without_time(execution.cost);
    return result;
  }
  const PartOfExecution second(execution, fraction, 1 - fraction);
  // Without time for it the states stand, without estimates.
  const StopReason stop = search_until_stopped(
      execution.cancellation, [] { return true; },
      [&] { estimate_errors(natural, scaled, options, second.execution(), result); });
  if (stop != StopReason::none) bill_estimate_without_time(execution.cost);
  return result;
}

}  // namespace supple::weave
