#include "supple/weave/homogenization.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>

#include "direction_sweep.h"
#include "natural_units.h"
#include "resolution_error.h"
#include "supple/base/best_so_far.h"
#include "supple/base/faults.h"
#include "supple/base/parallel_tasks.h"
#include "supple/base/part_of_execution.h"
#include "supple/weave/weave_error.h"
#include "weave_run.h"

namespace supple::weave {
namespace {

constexpr double newtons_per_metre = 1000;  ///< in one N/mm
constexpr double max_strain = 2;
constexpr double min_strain = -0.5;
/// Minimum number of directions for a comparison of neighbours. Fewer may have no neighbours that are near enough.
constexpr std::size_t min_directions_to_compare = 20;
/// Ratio of the load steps of a comparison path to those of the original path.
constexpr int finer_step_ratio = 3;
/// Maximum number of load steps of a comparison path.
constexpr int max_finer_steps = 1000;
/// Ratio of a cell's area to its area at rest below which the cell is folded flat: its strands lie beside each other.
constexpr double min_area_ratio = 1e-3;
/// Fraction of the progress before errors are estimated.
constexpr double fraction_before_estimate = 0.7;

void check(const Weave& weave, const EquilibriumOptions& options, const Execution& execution) {
  validate(weave, execution);
  validate(options);
  if (!weave.lattice)
    throw WeaveError("weave.not_periodic", "The weave has no lattice; only periodic cells are homogenized.");
}

void check_deformed(const std::vector<int>& indices, std::size_t count, const std::string& of, Faults& faults) {
  for (std::size_t i = 0; i < indices.size(); ++i)
    faults.require(indices[i] >= 0 && static_cast<std::size_t>(indices[i]) < count, "deformed/" + std::to_string(i),
                   "must be the index of a " + of);
}

void check_gradient(const Eigen::Matrix2d& f, const std::string& where, Faults& faults) {
  faults.require(f.allFinite() && f.determinant() > 0, where, "must be finite and of positive determinant");
}

void check(const HomogenizationOptions& options) {
  Faults faults;
  faults.require(options.strain >= min_strain && options.strain <= max_strain && options.strain != 0, "strain",
                 "must lie within [-0.5, 2] and not be 0");
  faults.require(!options.directions.empty(), "directions", "must not be empty");
  for (std::size_t i = 0; i < options.directions.size(); ++i)
    faults.require(std::isfinite(options.directions[i]), "directions/" + std::to_string(i), "must be finite, in rad");
  faults.require(!options.thickness || (*options.thickness > 0 && std::isfinite(*options.thickness)), "thickness",
                 "must be positive, in mm");
  check_deformed(options.deformed, options.directions.size(), "direction", faults);
  faults.throw_if_any<InvalidOption>("weave.invalid_option");
}

/// The reported state of a run, whose weave is in these units.
CellState state_of(WeaveRun& run, const NaturalUnits& units, bool arrived, bool with_polylines) {
  const LimitedState& reported = run.reported();
  const RodModel& model = run.model();
  const WeavePath& path = run.path();
  CellState state;
  const Eigen::VectorXd& q = reported.q;
  // Factor of an energy over the cell's area at rest, both in natural units.
  const double to_newtons_per_metre =
      newtons_per_metre * units.force_per_length() / model.weave().lattice->determinant();
  const Eigen::Matrix2d f = model.deformation_gradient(q);
  state.deformation_gradient = f;
  // The dyads are orthonormal, so that the derivative by F has these components along them.
  for (int k = 0; k < 4; ++k)
    state.nominal_stress +=
        to_newtons_per_metre * reported.gradient[model.strain() + k] * model.dyads()[static_cast<std::size_t>(k)];
  state.cauchy_stress = state.nominal_stress * f.transpose() / f.determinant();
  state.energy_density = to_newtons_per_metre * reported.energy;
  state.sliding.reserve(model.sliders().size());
  for (int i = 0; i < static_cast<int>(model.sliders().size()); ++i)
    state.sliding.push_back(units.length * q[model.slider(i)]);
  if (with_polylines) state.strands = polylines(model, q, units.length);
  state.out_of_plane = run.spatial();
  state.stable = reported.stable;
  state.stopped = path.termination();
  if (!arrived && state.stopped == Stop::converged) state.stopped = Stop::step_too_small;
  state.residual = units.force() * reported.residual;
  state.tolerance = units.force() * path.tolerance();
  state.limit_error = reported.limit_error;
  state.iterations = run.iterations();
  state.load_steps = run.load_steps();
  state.branches = run.branches();
  return state;
}

Prescription::Entry strain_entry(int component, double change) {
  return {Prescription::Entry::Kind::strain, component, 0, change};
}

/// Says for each of `count` entries whether it is among the indices.
std::vector<bool> chosen(const std::vector<int>& indices, std::size_t count) {
  std::vector<bool> result(count, false);
  for (const int i : indices) result[static_cast<std::size_t>(i)] = true;
  return result;
}

/// The equilibrium under a gradient that has already been checked.
CellState state_under(const NaturalWeave& natural, const Eigen::Matrix2d& f, const EquilibriumOptions& options,
                      const Execution& execution, bool with_polylines) {
  Prescription prescription;
  // With the direction along x, the dyads select the entries of the matrix, row by row.
  for (int k = 0; k < 4; ++k)
    prescription.fixed.push_back(strain_entry(k, f(k / 2, k % 2) - (k == 0 || k == 3 ? 1 : 0)));
  prescription.strain = (f - Eigen::Matrix2d::Identity()).cwiseAbs().maxCoeff();
  const CellPath path =
      follow_cell(natural.weave(), prescription, 0, in_natural_units(options, natural.units()), execution);
  CellState state = state_of(*path.run, natural.units(), path.arrived, with_polylines);
  path.run->bill_effects();
  return state;
}

/// Uniaxial strain F^T d = stretch d. It prescribes the first two of the components along d d^T, d n^T, n d^T, n n^T.
Prescription uniaxial(const HomogenizationOptions& options) {
  Prescription prescription;
  prescription.fixed = {strain_entry(0, options.strain), strain_entry(1, 0)};
  if (!options.shear_free) prescription.fixed.push_back(strain_entry(2, 0));
  prescription.strain = std::abs(options.strain);
  return prescription;
}

/// The response at the end of a run along a direction, or at the last equilibrium of a run that did not arrive.
DirectionalResponse response_of(WeaveRun& run, const NaturalUnits& units, const HomogenizationOptions& options,
                                double direction, bool arrived, bool with_polylines) {
  DirectionalResponse response;
  response.direction = direction;
  response.state = state_of(run, units, arrived, with_polylines);
  run.bill_effects();
  if (response.state.stopped == Stop::converged && response.state.deformation_gradient.determinant() < min_area_ratio) {
    response.state.stopped = Stop::folded_flat;
    response.state.cauchy_stress.setZero();
  }
  if (response.state.stopped != Stop::converged) return response;
  const Eigen::Vector2d d(std::cos(direction), std::sin(direction));
  const Eigen::Vector2d n(-d[1], d[0]);
  response.youngs_modulus = d.dot(response.state.cauchy_stress * d) / options.strain;
  // 1 N/m = 10^-3 N/mm.
  if (options.thickness) response.youngs_modulus_mpa = response.youngs_modulus / newtons_per_metre / *options.thickness;
  response.poisson_ratio = -(n.dot(response.state.deformation_gradient * n) - 1) / options.strain;
  return response;
}

/// Adds the directions' bills. The ledger keeps the latest reason of an effect; an effect that ran in some direction
/// gets the reason why it ran.
void add_bills(const std::vector<CostLedger>& bills, CostLedger& total) {
  for (const CostLedger& bill : bills) total.merge(bill);
  for (const CostLedger& bill : bills)
    for (const CostLedger::Effect& effect : bill.effects())
      if (effect.ran) total.add_effect(effect.name, true, effect.why);
}

Stop stop_by(StopReason reason) { return reason == StopReason::memory ? Stop::memory : Stop::deadline; }

/// Takes back a response that is not sure.
void withhold(DirectionalResponse& response, Stop stop) {
  const double direction = response.direction;
  response = {};
  response.direction = direction;
  response.state.stopped = stop;
}

/// A task that was not finished, and why.
struct Unfinished {
  std::size_t index = 0;
  Stop stop = Stop::deadline;
};

/// Runs n tasks in parallel and adds their bills. Returns those that the deadline or a limit of memory has stopped, if
/// others were finished by then.
std::vector<Unfinished> run_until_stopped(int n, const Execution& execution, std::string_view stage,
                                          const std::function<void(std::size_t, const Execution&)>& task) {
  std::vector<std::uint8_t> is_done(static_cast<std::size_t>(n), 0);
  std::vector<CostLedger> bills;
  const StopReason reason = search_until_stopped(
      execution.cancellation, [&] { return std::count(is_done.begin(), is_done.end(), 1) > 0; },
      [&] {
        bills = parallel_bills(n, execution, stage, [&](int index, const Execution& own) {
          const auto i = static_cast<std::size_t>(index);
          task(i, own);
          is_done[i] = 1;
        });
      });
  if (execution.cost) add_bills(bills, *execution.cost);
  std::vector<Unfinished> unfinished;
  for (std::size_t i = 0; i < is_done.size(); ++i)
    if (is_done[i] == 0) unfinished.push_back({i, stop_by(reason)});
  return unfinished;
}

}  // namespace

std::vector<double> directions_over_half_turn(int count) {
  std::vector<double> directions;
  directions.reserve(static_cast<std::size_t>(std::max(0, count)));
  for (int k = 0; k < count; ++k) directions.push_back(std::numbers::pi * k / count);
  return directions;
}

namespace {

/// The responses in all directions, without estimates of their errors.
std::vector<DirectionalResponse> follow_directions(const NaturalWeave& natural, const HomogenizationOptions& options,
                                                   const Execution& execution) {
  const EquilibriumOptions equilibrium = in_natural_units(options.equilibrium, natural.units());
  const Prescription prescription = uniaxial(options);
  const auto n = static_cast<int>(options.directions.size());
  const std::vector<bool> wanted = chosen(options.deformed, options.directions.size());
  std::vector<DirectionalResponse> responses(options.directions.size());
  const auto respond = [&](std::size_t i, const Execution& own) {
    const double direction = options.directions[i];
    const CellPath path = follow_cell(natural.weave(), prescription, direction, equilibrium, own);
    responses[i] = response_of(*path.run, natural.units(), options, direction, path.arrived, wanted[i]);
    // A direction without near neighbours, whose path left an unstable equilibrium, is compared with a finer path.
    if (responses[i].state.branches == 0 || options.directions.size() >= min_directions_to_compare) return;
    EquilibriumOptions finer = equilibrium;
    finer.load_steps = finer_step_ratio * responses[i].state.load_steps;
    if (equilibrium.buckling == Switch::off || finer.load_steps > max_finer_steps) return;
    const CellPath again = follow_cell(natural.weave(), prescription, direction, finer, own);
    std::vector<DirectionalResponse> one{std::move(responses[i])};
    replace_by_better({{0, response_of(*again.run, natural.units(), options, direction, again.arrived, wanted[i])}},
                      one);
    responses[i] = std::move(one.front());
  };
  const auto unfinished = run_until_stopped(n, execution, "directions", respond);
  for (const auto& [i, stop] : unfinished) {
    responses[i] = {};
    responses[i].direction = options.directions[i];
    responses[i].state.stopped = stop;
  }
  if (equilibrium.buckling == Switch::off || !unfinished.empty()) return responses;
  // A direction whose energy is far above the value that its neighbours suggest is computed again from their states.
  const DirectionOrder order(responses);
  const std::vector<SweepStart> starts = suspicious_directions(responses, order, options);
  std::vector<std::vector<BetterResponse>> found(starts.size());
  const Execution unreported{execution.cancellation, nullptr, execution.cost};
  const auto sweep = [&](int index, const Execution& own) {
    const auto [position, upwards] = starts[static_cast<std::size_t>(index)];
    const double from = options.directions[order.index(position)];
    const CellPath first = follow_cell(natural.weave(), prescription, from, equilibrium, own);
    if (!first.arrived) return;
    CellConfiguration at = first.run->configuration();
    auto next = order.neighbour(position, upwards);
    for (std::size_t steps = 1; next && steps < order.size(); ++steps, next = order.neighbour(*next, upwards)) {
      const std::size_t i = order.index(*next);
      WeaveRun run(natural.weave(), prescription, options.directions[i], equilibrium, own);
      if (!run.continue_from(at)) return;
      auto response = response_of(run, natural.units(), options, options.directions[i], true, wanted[i]);
      if (!is_better(response, responses[i])) return;
      at = run.configuration();
      found[static_cast<std::size_t>(index)].push_back({i, std::move(response)});
    }
  };
  std::vector<CostLedger> more_bills;
  const StopReason stop = search_until_stopped(
      execution.cancellation, [] { return true; },
      [&] {
        more_bills = parallel_bills(static_cast<int>(starts.size()), unreported, "neighbouring directions", sweep);
      });
  if (execution.cost) add_bills(more_bills, *execution.cost);
  for (auto& better : found) replace_by_better(std::move(better), responses);
  // What was not compared to the end may be no equilibrium of least energy.
  for (const auto& [position, upwards] : starts)
    if (stop != StopReason::none)
      withhold(responses[order.index(order.neighbour(position, upwards).value())], stop_by(stop));
  return responses;
}

/// Estimates the errors of the responses, of which some are followed once more with rods of another resolution. Bills
/// the time to the effect; what these directions did is no part of the answer.
void estimate_errors(const NaturalWeave& natural, const HomogenizationOptions& options, const Execution& execution,
                     std::vector<DirectionalResponse>& responses) {
  const EstimateTimer timer(execution.cost);
  const OtherResolution other = other_resolution(options.equilibrium);
  const std::vector<std::size_t> indices = compared_directions(responses, options.equilibrium.error_estimate);
  HomogenizationOptions again = options;
  again.equilibrium = other.equilibrium;
  again.deformed.clear();
  again.directions.clear();
  for (const std::size_t i : indices) again.directions.push_back(options.directions[i]);
  const auto compared = follow_directions(natural, again, {execution.cancellation, execution.progress, nullptr});
  const double area = natural.units().length * natural.units().length * natural.weave().lattice->determinant();
  set_errors(indices, compared, other.factor, area, options, responses);
  const auto is_finished = [](const DirectionalResponse& one) { return !is_cut_short(one.state.stopped); };
  timer.bill({.count = static_cast<std::size_t>(std::ranges::count_if(compared, is_finished)),
              .total = responses.size(),
              .entries = "directions",
              .segments = other.equilibrium.segments});
}

/// The states under gradients that have been checked, with polylines of the `deformed` ones.
std::vector<CellState> states_under(const NaturalWeave& natural, const std::vector<Eigen::Matrix2d>& gradients,
                                    const EquilibriumOptions& options, const std::vector<int>& deformed,
                                    const Execution& execution) {
  const std::vector<bool> wanted = chosen(deformed, gradients.size());
  std::vector<CellState> states(gradients.size());
  const auto unfinished = run_until_stopped(static_cast<int>(states.size()), execution, "gradients",
                                            [&](std::size_t i, const Execution& own) {
                                              states[i] = state_under(natural, gradients[i], options, own, wanted[i]);
                                            });
  for (const auto& [i, stop] : unfinished) {
    states[i] = {};
    states[i].stopped = stop;
  }
  return states;
}

/// Estimates the errors of states, of which some are computed once more with rods of another resolution.
void estimate_errors(const NaturalWeave& natural, const std::vector<Eigen::Matrix2d>& gradients,
                     const EquilibriumOptions& options, const Execution& execution, std::vector<CellState>& states) {
  const EstimateTimer timer(execution.cost);
  const OtherResolution other = other_resolution(options);
  const std::vector<std::size_t> indices = compared_positions(states.size(), options.error_estimate);
  std::vector<Eigen::Matrix2d> again;
  again.reserve(indices.size());
  for (const std::size_t i : indices) again.push_back(gradients[i]);
  const auto compared =
      states_under(natural, again, other.equilibrium, {}, {execution.cancellation, execution.progress, nullptr});
  set_errors(indices, compared, other.factor, states);
  const auto is_finished = [](const CellState& one) { return !is_cut_short(one.stopped); };
  timer.bill({.count = static_cast<std::size_t>(std::ranges::count_if(compared, is_finished)),
              .total = states.size(),
              .entries = "deformation gradients",
              .segments = other.equilibrium.segments});
}

}  // namespace

std::vector<DirectionalResponse> homogenize(const Weave& weave, const HomogenizationOptions& options,
                                            const Execution& execution) {
  check(weave, options.equilibrium, execution);
  check(options);
  const NaturalWeave natural(weave);
  const bool estimates = options.equilibrium.error_estimate != Switch::off;
  const PartOfExecution first(execution, 0, estimates ? fraction_before_estimate : 1);
  auto responses = follow_directions(natural, options, first.execution());
  if (!estimates) {
    bill_no_estimate(Switch::off, execution.cost);
    return responses;
  }
  const auto is_unfinished = [](const DirectionalResponse& response) { return is_cut_short(response.state.stopped); };
  if (std::ranges::any_of(responses, is_unfinished)) {
    bill_estimate_without_time(execution.cost);
    return responses;
  }
  const PartOfExecution second(execution, fraction_before_estimate, 1 - fraction_before_estimate);
  // Without time for it the responses stand, without estimates.
  const StopReason stop = search_until_stopped(
      execution.cancellation, [] { return true; },
      [&] { estimate_errors(natural, options, second.execution(), responses); });
  if (stop != StopReason::none) bill_estimate_without_time(execution.cost);
  return responses;
}

CellState deform_cell(const Weave& weave, const Eigen::Matrix2d& deformation_gradient,
                      const EquilibriumOptions& options, const Execution& execution, bool with_polylines) {
  check(weave, options, execution);
  Faults faults;
  check_gradient(deformation_gradient, "deformation_gradient", faults);
  faults.throw_if_any<InvalidLoad>("weave.invalid_load");
  return state_under(NaturalWeave(weave), deformation_gradient, options, execution, with_polylines);
}

std::vector<CellState> deform_cells(const Weave& weave, const std::vector<Eigen::Matrix2d>& deformation_gradients,
                                    const EquilibriumOptions& options, const std::vector<int>& deformed,
                                    const Execution& execution) {
  check(weave, options, execution);
  Faults faults;
  faults.require(!deformation_gradients.empty(), "deformation_gradients", "must not be empty");
  for (std::size_t i = 0; i < deformation_gradients.size(); ++i)
    check_gradient(deformation_gradients[i], "deformation_gradients/" + std::to_string(i), faults);
  check_deformed(deformed, deformation_gradients.size(), "deformation gradient", faults);
  faults.throw_if_any<InvalidLoad>("weave.invalid_load");
  const NaturalWeave natural(weave);
  const bool estimates = options.error_estimate != Switch::off;
  const PartOfExecution first(execution, 0, estimates ? fraction_before_estimate : 1);
  auto states = states_under(natural, deformation_gradients, options, deformed, first.execution());
  if (!estimates) {
    bill_no_estimate(Switch::off, execution.cost);
    return states;
  }
  if (std::ranges::any_of(states, [](const CellState& state) { return is_cut_short(state.stopped); })) {
    bill_estimate_without_time(execution.cost);
    return states;
  }
  const PartOfExecution second(execution, fraction_before_estimate, 1 - fraction_before_estimate);
  // Without time for it the states stand, without estimates.
  const StopReason stop = search_until_stopped(
      execution.cancellation, [] { return true; },
      [&] { estimate_errors(natural, deformation_gradients, options, second.execution(), states); });
  if (stop != StopReason::none) bill_estimate_without_time(execution.cost);
  return states;
}

}  // namespace supple::weave
