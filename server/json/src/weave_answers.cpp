#include "supple/json/weave_answers.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <string_view>
#include <utility>

#include "answer_parts.h"
#include "supple/weave/drawing.h"
#include "supple/weave/export.h"

namespace supple::json {
namespace {

using weave::CellState;
using weave::DirectionalResponse;
using weave::Weave;

template <class Points>
void write_points(JsonWriter& out, const Points& points) {
  out.begin_array();
  for (const auto& point : points) out.numbers(point);
  out.end_array();
}

void write_strand(JsonWriter& out, const weave::Strand& strand, const Execution& execution) {
  out.begin_object().field("ends", ends_names.name_of(strand.curve.ends()));
  out.key("translation").numbers(strand.curve.translation());
  out.field("length", strand.curve.length()).field("radius", strand.radius).key("polyline");
  write_points(out, weave::polyline(strand.curve, execution));
  out.end_object();
}

/// Writes a member in the form of a request.
void write_member(JsonWriter& out, const weave::CrossingMember& member) {
  out.begin_object().field("strand", member.strand).field("coordinate", member.coordinate);
  out.key("shift").begin_array().integer(member.shift[0]).integer(member.shift[1]).end_array();
  out.field("slides", member.slides);
  if (member.slides) {
    write_number_or_null(out, "backward", member.backward);
    write_number_or_null(out, "forward", member.forward);
  }
  out.end_object();
}

void write_sliders(JsonWriter& out, const Weave& weave) {
  out.key("sliders").begin_array();
  for (std::size_t c = 0; c < weave.crossings.size(); ++c) {
    const auto& members = weave.crossings[c].members;
    for (std::size_t m = 0; m < members.size(); ++m)
      if (members[m].slides) out.begin_object().field("crossing", c).field("member", m).end_object();
  }
  out.end_array();
}

template <class Polylines>
void write_polylines(JsonWriter& out, const Polylines& strands) {
  out.key("strands").begin_array();
  for (const auto& strand : strands) write_points(out, strand);
  out.end_array();
}

/// The largest ratio of a residual to its tolerance. A value that is not a number stays.
class LargestResidual {
 public:
  void add(double residual, double tolerance) {
    const double relative = residual / tolerance;
    if (!(relative <= largest_)) largest_ = relative;
  }
  double value() const { return largest_; }

 private:
  double largest_ = 0;
};

void write_accuracy(JsonWriter& out, const weave::EquilibriumOptions& options, const LargestResidual& residual,
                    const LargestResidual& limit_error) {
  out.key("accuracy").begin_object().field("segments", options.segments).field("tolerance", options.tolerance);
  write_number_or_null(out, "residual", residual.value());
  out.field("limit_tolerance", options.limit_tolerance);
  write_number_or_null(out, "limit_error", limit_error.value());
}

/// A sentence that tells in how many of `states`, which it calls `name`, sliders stand short of their limits by more
/// than was allowed; empty if in none. `error_of(state)` is the error of the energy.
template <class State, class ErrorOf>
std::string message_about_limits(const std::vector<State>& states, const std::string& name,
                                 const weave::EquilibriumOptions& options, ErrorOf error_of) {
  const auto short_of_limits = std::count_if(
      states.begin(), states.end(), [&](const State& state) { return !(error_of(state) <= options.limit_tolerance); });
  if (short_of_limits == 0 || options.limit_tolerance >= 1) return {};
  return "In " + std::to_string(short_of_limits) + " of " + std::to_string(states.size()) + " " + name +
         " sliders stand short of their limits; `limit_error` says how much too high the energy may be.";
}

std::string sentences(const std::string& one, const std::string& other) {
  return one + (one.empty() || other.empty() ? "" : " ") + other;
}

/// Writes an array; write(entry) writes each entry.
template <class Entry, class Write>
void write_each(JsonWriter& out, std::string_view name, const std::vector<Entry>& entries, Write write) {
  out.key(name).begin_array();
  for (const auto& entry : entries) write(entry);
  out.end_array();
}

void write_moduli(JsonWriter& out, bool with_thickness, const std::vector<DirectionalResponse>& responses) {
  const auto number_or_null = [&](double value) { write_number_or_null(out, value); };
  write_each(out, "youngs_modulus", responses, [&](const auto& r) { number_or_null(r.youngs_modulus); });
  if (with_thickness)
    write_each(out, "youngs_modulus_mpa", responses, [&](const auto& r) { number_or_null(r.youngs_modulus_mpa); });
  write_each(out, "poisson_ratio", responses, [&](const auto& r) { number_or_null(r.poisson_ratio); });
  write_each(out, "youngs_modulus_error", responses, [&](const auto& r) { number_or_null(r.youngs_modulus_error); });
  write_each(out, "poisson_ratio_error", responses, [&](const auto& r) { number_or_null(r.poisson_ratio_error); });
}

const CellState& state_in(const CellState& state) { return state; }
const CellState& state_in(const DirectionalResponse& response) { return response.state; }

/// Writes arrays about the states that the entries are or have.
template <class Entry>
void write_cell_states(JsonWriter& out, const std::vector<Entry>& entries) {
  const auto write_field = [&](std::string_view name, auto member, auto write) {
    write_each(out, name, entries, [&](const Entry& entry) { write(state_in(entry).*member); });
  };
  const auto write_matrix = [&](const Eigen::Matrix2d& matrix) { write_rows(out, matrix); };
  const auto write_boolean = [&](bool value) { out.boolean(value); };
  const auto write_integer = [&](int value) { out.integer(value); };
  const auto number_or_null = [&](double value) { write_number_or_null(out, value); };
  write_field("deformation_gradient", &CellState::deformation_gradient, write_matrix);
  write_field("nominal_stress", &CellState::nominal_stress, write_matrix);
  write_field("cauchy_stress", &CellState::cauchy_stress, write_matrix);
  write_field("energy_density", &CellState::energy_density, [&](double value) { out.number(value); });
  write_field("stopped", &CellState::stopped, [&](weave::Stop stop) { out.string(weave::to_string(stop)); });
  write_field("residual", &CellState::residual, number_or_null);
  write_field("out_of_plane", &CellState::out_of_plane, write_boolean);
  write_field("stable", &CellState::stable, write_boolean);
  write_field("iterations", &CellState::iterations, write_integer);
  write_field("load_steps", &CellState::load_steps, write_integer);
  write_field("branches", &CellState::branches, write_integer);
  write_field("limit_error", &CellState::limit_error, number_or_null);
}

/// A sentence about the entries that did not converge; empty if all did. It calls the entries `name`, and
/// `failure_words` tells what became of them.
template <class Entry>
std::string message_about_failures(const std::vector<Entry>& entries, const std::string& name,
                                   const std::string& failure_words) {
  const auto failed = std::count_if(entries.begin(), entries.end(),
                                    [](const Entry& e) { return state_in(e).stopped != weave::Stop::converged; });
  if (failed == 0) return {};
  return std::to_string(failed) + " of " + std::to_string(entries.size()) + " " + name + " " + failure_words +
         "; `stopped` says why.";
}

template <class Entry>
std::string message_about(const std::vector<Entry>& entries, const std::string& name, const std::string& failure_words,
                          const weave::EquilibriumOptions& options) {
  const auto limit_error = [](const Entry& entry) { return state_in(entry).limit_error; };
  return sentences(message_about_failures(entries, name, failure_words),
                   message_about_limits(entries, name, options, limit_error));
}

/// Writes the deformed cells that were asked for; `number` names the field of their index.
template <class Entry>
void write_cells(JsonWriter& out, std::string_view number, const std::vector<int>& deformed, const Weave& weave,
                 const std::vector<Entry>& entries) {
  out.key("cells").begin_array();
  for (const int index : deformed) {
    const CellState& state = state_in(entries[static_cast<std::size_t>(index)]);
    out.begin_object().field(number, index);
    write_lattice(out, state.deformation_gradient * *weave.lattice);
    write_polylines(out, state.strands);
    out.key("sliding").numbers(state.sliding).end_object();
  }
  out.end_array();
}

/// The root mean square of estimated errors over that of the values; not a number where none was estimated.
class RelativeErrors {
 public:
  void add(double error, double value) {
    if (!std::isfinite(error)) return;
    errors_ += error * error;
    values_ += value * value;
    ++count_;
  }
  /// The same of the errors alone.
  double absolute() const { return std::sqrt(errors_ / static_cast<double>(count_)); }
  double value() const { return std::sqrt(errors_ / values_); }

 private:
  double errors_ = 0;
  double values_ = 0;
  std::size_t count_ = 0;
};

/// Writes the field "discretization_error" with one error for each name; null where none is known.
void write_discretization_error(JsonWriter& out, std::initializer_list<std::pair<std::string_view, double>> errors) {
  out.key("discretization_error");
  if (std::any_of(errors.begin(), errors.end(), [](const auto& error) { return !std::isfinite(error.second); })) {
    out.null();
    return;
  }
  out.begin_object();
  for (const auto& [name, error] : errors) out.field(name, error);
  out.end_object();
}

void write_discretization_error(JsonWriter& out, const std::vector<DirectionalResponse>& responses) {
  RelativeErrors modulus;
  RelativeErrors poisson;
  for (const auto& response : responses) {
    modulus.add(response.youngs_modulus_error, response.youngs_modulus);
    poisson.add(response.poisson_ratio_error, response.poisson_ratio);
  }
  write_discretization_error(out, {{"youngs_modulus", modulus.value()}, {"poisson_ratio", poisson.absolute()}});
}

void write_discretization_error(JsonWriter& out, const std::vector<CellState>& states) {
  RelativeErrors stress;
  RelativeErrors energy;
  for (const auto& state : states) {
    stress.add(state.stress_error, state.cauchy_stress.norm());
    energy.add(state.energy_error, state.energy_density);
  }
  write_discretization_error(out, {{"stress", stress.value()}, {"energy", energy.value()}});
}

void write_discretization_error(JsonWriter& out, const std::vector<weave::SheetState>& states) {
  RelativeErrors reactions;
  RelativeErrors energy;
  for (const auto& state : states) {
    double largest = 0;
    for (const auto& reaction : state.reactions) largest = std::max(largest, reaction.norm());
    reactions.add(state.reaction_error, largest);
    energy.add(state.energy_error, state.energy);
  }
  write_discretization_error(out, {{"reactions", reactions.value()}, {"energy", energy.value()}});
}

template <class Entry>
void write_cell_accuracy(JsonWriter& out, const weave::EquilibriumOptions& options, const std::vector<Entry>& entries) {
  LargestResidual residual;
  LargestResidual limit_error;
  for (const Entry& entry : entries) {
    if (state_in(entry).tolerance == 0) continue;  // it was not computed, since time or memory ran out
    residual.add(state_in(entry).residual, state_in(entry).tolerance);
    limit_error.add(state_in(entry).limit_error, 1);
  }
  write_accuracy(out, options, residual, limit_error);
  write_discretization_error(out, entries);
  out.end_object();
}

void write_deformed(JsonWriter& out, DeformedStrands deformed, const Weave& weave, const weave::SheetState& state) {
  switch (deformed) {
    case DeformedStrands::none:
      return;
    case DeformedStrands::json:
      return write_polylines(out, state.strands);
    case DeformedStrands::obj:
      out.field("obj", weave::write_obj(state.strands));
      return;
    case DeformedStrands::vtu:
      out.field("vtu", weave::write_vtu(weave, state.strands));
  }
}

void write_sheet_state(JsonWriter& out, DeformedStrands deformed, const Weave& weave, const weave::SheetState& state) {
  out.begin_object().field("share", state.share).field("energy", state.energy).key("crossings");
  write_points(out, state.crossings);
  out.key("sliding").numbers(state.sliding).key("reactions");
  write_points(out, state.reactions);
  out.field("out_of_plane", state.out_of_plane).field("stable", state.stable);
  out.field("stopped", weave::to_string(state.stopped));
  write_number_or_null(out, "residual", state.residual);
  write_number_or_null(out, "limit_error", state.limit_error);
  write_number_or_null(out, "energy_error", state.energy_error);
  write_number_or_null(out, "reaction_error", state.reaction_error);
  out.field("iterations", state.iterations).field("load_steps", state.load_steps).field("branches", state.branches);
  write_deformed(out, deformed, weave, state);
  out.end_object();
}

}  // namespace

std::string write_weave_layout(const Weave& weave, const std::vector<std::string>& warnings, const std::string* svg,
                               const Bill& bill, const Execution& execution) {
  JsonWriter out;
  out.begin_object().key("strands").begin_array();
  for (const auto& strand : weave.strands) {
    execution.cancellation.throw_if_requested();
    write_strand(out, strand, execution);
  }
  out.end_array().key("crossings").begin_array();
  for (const auto& crossing : weave.crossings) {
    execution.cancellation.throw_if_requested();
    out.begin_object().key("position").numbers(weave::rest_position(weave, crossing.members.front()));
    out.key("members").begin_array();
    for (const auto& member : crossing.members) write_member(out, member);
    out.end_array().end_object();
  }
  out.end_array();
  if (weave.lattice) {
    write_lattice(out, *weave.lattice);
  } else {
    out.key("lattice").null();
  }
  out.key("material")
      .begin_object()
      .field("youngs_modulus", weave.material.youngs_modulus)
      .field("poisson_ratio", weave.material.poisson_ratio)
      .end_object();
  out.key("warnings").begin_array();
  for (const auto& warning : warnings) out.string(warning);
  out.end_array();
  if (svg) out.field("svg", *svg);
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

std::string write_weave_homogenization(const WeaveHomogenizationRequest& request, const Weave& weave,
                                       const std::vector<DirectionalResponse>& responses, const Bill& bill) {
  const auto& options = request.options;
  JsonWriter out;
  out.begin_object().field("strain", options.strain).key("directions").numbers(options.directions);
  write_moduli(out, options.thickness.has_value(), responses);
  write_cell_states(out, responses);
  out.field("message", message_about(responses, "directions", "have no value", options.equilibrium));
  write_sliders(out, weave);
  write_cells(out, "direction", options.deformed, weave, responses);
  write_cell_accuracy(out, options.equilibrium, responses);
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

std::string write_weave_deformation(const WeaveDeformationRequest& request, const Weave& weave,
                                    const std::vector<CellState>& states, const Bill& bill) {
  JsonWriter out;
  out.begin_object();
  write_cell_states(out, states);
  const auto number_or_null = [&](double value) { write_number_or_null(out, value); };
  write_each(out, "cauchy_stress_error", states, [&](const auto& state) { number_or_null(state.stress_error); });
  write_each(out, "energy_density_error", states, [&](const auto& state) { number_or_null(state.energy_error); });
  out.field("message", message_about(states, "deformation gradients", "were not reached", request.options));
  write_sliders(out, weave);
  write_cells(out, "state", request.deformed, weave, states);
  write_cell_accuracy(out, request.options, states);
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

std::string write_weave_simulation(const WeaveSimulationRequest& request, const Weave& weave,
                                   const std::vector<SupportPoint>& places, const weave::SimulationResult& result,
                                   const Bill& bill) {
  JsonWriter out;
  out.begin_object().key("supports").begin_array();
  for (const auto& place : places) {
    const auto& curve = weave.strands[static_cast<std::size_t>(place.strand)].curve;
    out.begin_object()
        .field("support", place.support)
        .field("strand", place.strand)
        .field("coordinate", place.coordinate);
    out.key("position").numbers(curve.at(place.coordinate).position).end_object();
  }
  out.end_array();
  write_sliders(out, weave);
  out.key("states").begin_array();
  for (const auto& state : result.states) write_sheet_state(out, request.deformed, weave, state);
  out.end_array().field(
      "message", sentences(result.message, message_about_limits(result.states, "states", request.options,
                                                                [](const auto& state) { return state.limit_error; })));
  LargestResidual residual;
  LargestResidual limit_error;
  for (const auto& state : result.states) {
    residual.add(state.residual, state.tolerance);
    limit_error.add(state.limit_error, 1);
  }
  write_accuracy(out, request.options, residual, limit_error);
  write_discretization_error(out, result.states);
  out.field("unknowns", result.unknowns).end_object();
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

}  // namespace supple::json
