#include "supple/weave/homogenization.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "supple/base/error.h"
#include "supple/base/faults.h"
#include "supple/base/parallel_tasks.h"
#include "weave_run.h"

namespace supple::weave {
namespace {

constexpr double newtons_per_metre = 1000;  ///< in a N/mm
constexpr double largest_strain = 2;
constexpr double smallest_strain = -0.5;
/// Over that at rest: where a cell free to narrow has less, its strands lie beside each other.
constexpr double least_area = 1e-3;

void check(const Weave& weave, const EquilibriumOptions& options, const Execution& execution) {
  validate(weave, execution);
  validate(options);
  if (!weave.lattice)
    throw Error("weave.not_periodic", "The weave has no lattice; only periodic cells are homogenized.");
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
  faults.require(options.strain >= smallest_strain && options.strain <= largest_strain && options.strain != 0, "strain",
                 "must lie within [-0.5, 2] and not be 0");
  faults.require(!options.directions.empty(), "directions", "must not be empty");
  for (std::size_t i = 0; i < options.directions.size(); ++i)
    faults.require(std::isfinite(options.directions[i]), "directions/" + std::to_string(i), "must be finite, in rad");
  faults.require(!options.thickness || (*options.thickness > 0 && std::isfinite(*options.thickness)), "thickness",
                 "must be positive, in mm");
  check_deformed(options.deformed, options.directions.size(), "direction", faults);
  faults.throw_if_any("weave.invalid_option");
}

CellState state_of(WeaveRun& run, const Weave& weave, bool arrived, bool lines) {
  WeaveSystem& objective = run.objective();
  const RodModel& model = run.model();
  const WeavePath& path = run.path();
  CellState state;
  const Eigen::VectorXd gradient = objective.full_gradient();
  const Eigen::VectorXd& q = objective.q();
  const double area = weave.lattice->determinant();
  const Eigen::Matrix2d f = model.deformation_gradient(q);
  state.deformation_gradient = f;
  // The dyads are orthonormal: the derivative by F has these components along them.
  for (int k = 0; k < 4; ++k)
    state.nominal_stress +=
        newtons_per_metre / area * gradient[model.strain() + k] * model.dyads()[static_cast<std::size_t>(k)];
  state.cauchy_stress = state.nominal_stress * f.transpose() / f.determinant();
  state.energy_density = newtons_per_metre * path.energy() / area;
  state.sliding.reserve(model.sliders().size());
  for (int i = 0; i < static_cast<int>(model.sliders().size()); ++i) state.sliding.push_back(q[model.slider(i)]);
  if (lines) state.strands = polylines(model, q);
  state.out_of_plane = run.spatial();
  state.stable = path.stable();
  state.stopped = path.stopped();
  if (!arrived && state.stopped == Stop::converged) state.stopped = Stop::step_too_small;
  state.residual = path.residual();
  state.tolerance = path.tolerance();
  state.iterations = run.iterations();
  state.load_steps = run.load_steps();
  state.branches = run.branches();
  return state;
}

Prescription::Entry strain_entry(int component, double change) {
  return {Prescription::Entry::Kind::strain, component, 0, change};
}

/// For each of so many entries whether it is among the indices.
std::vector<bool> chosen(const std::vector<int>& indices, std::size_t count) {
  std::vector<bool> result(count, false);
  for (const int i : indices) result[static_cast<std::size_t>(i)] = true;
  return result;
}

/// The equilibrium under a gradient that has been checked.
CellState state_under(const Weave& weave, const Eigen::Matrix2d& f, const EquilibriumOptions& options,
                      const Execution& execution, bool lines) {
  Prescription prescription;
  // Along the axes the dyads are the matrix' entries, row by row.
  for (int k = 0; k < 4; ++k)
    prescription.held.push_back(strain_entry(k, f(k / 2, k % 2) - (k == 0 || k == 3 ? 1 : 0)));
  prescription.strain = (f - Eigen::Matrix2d::Identity()).cwiseAbs().maxCoeff();
  WeaveRun run(weave, prescription, 0, options, execution);
  const bool arrived = run.advance_to(1);
  run.bill_effects();
  return state_of(run, weave, arrived, lines);
}

DirectionalResponse respond(const Weave& weave, const HomogenizationOptions& options, double direction, bool lines,
                            const Execution& execution) {
  // F^T d = stretch d: of the components along d d^T, d n^T, n d^T, n n^T the first two are given.
  Prescription prescription;
  prescription.held = {strain_entry(0, options.strain), strain_entry(1, 0)};
  if (!options.shear_free) prescription.held.push_back(strain_entry(2, 0));
  prescription.strain = std::abs(options.strain);
  WeaveRun run(weave, prescription, direction, options.equilibrium, execution);
  const bool arrived = run.advance_to(1);
  run.bill_effects();
  DirectionalResponse response;
  response.direction = direction;
  response.state = state_of(run, weave, arrived, lines);
  if (response.state.stopped == Stop::converged && response.state.deformation_gradient.determinant() < least_area) {
    response.state.stopped = Stop::folded_flat;
    response.state.cauchy_stress.setZero();
  }
  if (response.state.stopped != Stop::converged) return response;
  const Eigen::Vector2d d(std::cos(direction), std::sin(direction));
  const Eigen::Vector2d n(-d[1], d[0]);
  response.youngs_modulus = d.dot(response.state.cauchy_stress * d) / options.strain;
  // N/m are 10^-3 N/mm.
  if (options.thickness) response.youngs_modulus_mpa = response.youngs_modulus / newtons_per_metre / *options.thickness;
  response.poisson_ratio = -(n.dot(response.state.deformation_gradient * n) - 1) / options.strain;
  return response;
}

/// Adds the directions' bills. The ledger keeps the latest reason; of an effect that ran somewhere it is to say why.
void add_bills(const std::vector<CostLedger>& bills, CostLedger& total) {
  for (const CostLedger& bill : bills) total.merge(bill);
  for (const CostLedger& bill : bills)
    for (const CostLedger::Effect& effect : bill.effects())
      if (effect.ran) total.add_effect(effect.name, true, effect.why);
}

}  // namespace

std::vector<double> directions_over_half_turn(int count) {
  std::vector<double> directions;
  directions.reserve(static_cast<std::size_t>(std::max(0, count)));
  for (int k = 0; k < count; ++k) directions.push_back(std::numbers::pi * k / count);
  return directions;
}

std::vector<DirectionalResponse> homogenize(const Weave& weave, const HomogenizationOptions& options,
                                            const Execution& execution) {
  check(weave, options.equilibrium, execution);
  check(options);
  const auto n = static_cast<int>(options.directions.size());
  const std::vector<bool> wanted = chosen(options.deformed, options.directions.size());
  std::vector<DirectionalResponse> responses(options.directions.size());
  const auto bills = parallel_bills(n, execution, "directions", [&](int index, const Execution& own) {
    const auto i = static_cast<std::size_t>(index);
    responses[i] = respond(weave, options, options.directions[i], wanted[i], own);
  });
  if (execution.cost) add_bills(bills, *execution.cost);
  return responses;
}

CellState deform_cell(const Weave& weave, const Eigen::Matrix2d& deformation_gradient,
                      const EquilibriumOptions& options, const Execution& execution, bool lines) {
  check(weave, options, execution);
  Faults faults;
  check_gradient(deformation_gradient, "deformation_gradient", faults);
  faults.throw_if_any("weave.invalid_load");
  return state_under(weave, deformation_gradient, options, execution, lines);
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
  faults.throw_if_any("weave.invalid_load");
  const std::vector<bool> wanted = chosen(deformed, deformation_gradients.size());
  std::vector<CellState> states(deformation_gradients.size());
  const auto bills =
      parallel_bills(static_cast<int>(states.size()), execution, "gradients", [&](int index, const Execution& own) {
        const auto i = static_cast<std::size_t>(index);
        states[i] = state_under(weave, deformation_gradients[i], options, own, wanted[i]);
      });
  if (execution.cost) add_bills(bills, *execution.cost);
  return states;
}

}  // namespace supple::weave
