#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "euclidean_springs.h"
#include "geodesic_elements.h"
#include "relaxation_run.h"
#include "supple/base/faults.h"

namespace supple::embedded {
namespace {

/// Steps shorter than this share of the mesh diagonal do not move a point in double precision.
constexpr double shortest_step = 1e-16;
constexpr int max_backtracks_of_a_step = 40;
/// Directions of negative curvature are left by steps that are doubled up to this often, in length.
constexpr double longest_expansion = 64;
/// Forces of a host are known to this share of its stiffness times the mesh diagonal: where the network is that much
/// weaker, the tolerance is this.
constexpr double host_rounding = 1e-14;

/// Energies of a host of small strains are known to this share.
constexpr double host_value_rounding = 1e-12;
/// A step that lowers the energy by less than this share of what its slope promises goes to and fro across a kink.
constexpr double creeping_share = 1e-3;

numerics::MinimizerMethod minimizer_method(RelaxationMethod method) {
  switch (method) {
    case RelaxationMethod::newton:
      return numerics::MinimizerMethod::newton;
    case RelaxationMethod::lbfgs:
      return numerics::MinimizerMethod::lbfgs;
    case RelaxationMethod::gradient_descent:
      break;
  }
  return numerics::MinimizerMethod::gradient_descent;
}

}  // namespace

NetworkState RelaxationRun::first_state() const {
  if (!host_.gives_way()) return {solver_.mesh(), network_.points};
  // The solver is the caller's, who keeps it.
  return {std::shared_ptr<const surface::GeodesicSolver>(std::shared_ptr<void>(), &solver_), network_.points,
          host_.nodes()};
}

std::vector<bool> RelaxationRun::held(const std::vector<bool>& points) const {
  std::vector<bool> coordinates = held_coordinates(points);
  coordinates.insert(coordinates.end(), host_.held().begin(), host_.held().end());
  return coordinates;
}

std::shared_ptr<numerics::Term<NetworkState>> RelaxationRun::make_term(bool mollified,
                                                                       std::vector<bool> held_points) const {
  if (!is_geodesic()) return std::make_shared<EuclideanSprings>(network_);
  return std::make_shared<GeodesicElements>(
      moved_ ? *moved_ : solver_, network_, std::move(held_points),
      GeodesicElementsOptions{.kept_strips = keeps_strips(),
                              .mollifier_length = mollified ? options_.mollifier_length : 0});
}

numerics::MinimizerOptions RelaxationRun::minimizer_options() const {
  const double diagonal = solver_.mesh().diagonal();
  numerics::MinimizerOptions options;
  options.method = minimizer_method(options_.method);
  options.gradient_tolerance =
      std::max(options_.tolerance * largest_weight(network_), host_rounding * host_.stiffness()) * diagonal;
  options.step_tolerance = shortest_step * diagonal;
  options.max_backtracks = max_backtracks_of_a_step;
  options.longest_expansion = longest_expansion;
  options.creeping_share = creeping_share;
  if (host_.gives_way()) options.value_rounding = host_value_rounding;
  // The length of a first step without curvature: that of a point which all others leave alone.
  if (const double stiffness = std::max(points_.largest_stiffness, host_.stiffness()); stiffness > 0)
    options.first_step = 1 / stiffness;
  return options;
}

void RelaxationRun::tell(const numerics::MinimizerStep& step, const NetworkState& state) {
  result_.history.push_back({step.value, step.gradient_norm, step.step_length, step.regularization});
  if (options_.observer) options_.observer(result_.history.back(), state.points(), state.mesh());
}

RelaxationRun::Stop RelaxationRun::minimize(bool mollified, const Execution& execution,
                                            const std::vector<bool>& held_points) {
  const bool again = !result_.history.empty();
  NetworkState start = host_.gives_way() ? state_ : NetworkState(solver().mesh(), state_.points());
  // The network last: where its paths lead over other faces, only its own places in the Hessian are new.
  Terms terms = host_.terms();
  terms.push_back(make_term(mollified, held_points));
  numerics::System<NetworkState> system(std::move(start), terms, numerics::Unknowns(held(held_points)),
                                        {.execution = execution_});
  if (!network_.triangles.empty() && !std::isfinite(system.evaluate(0).value)) refuse_collapsed(system.state());
  numerics::MinimizerOptions options = minimizer_options();
  options.max_iterations = std::max(0, iteration_limit_ - result_.iterations - (again ? 1 : 0));
  options.after_step = [&](const numerics::MinimizerStep& step) { tell(step, system.state()); };
  const numerics::MinimizerResult found = numerics::minimize(system, options, execution);
  result_.iterations += found.iterations + (again ? 1 : 0);
  result_.energy = found.value;
  result_.gradient_norm = found.gradient_norm;
  result_.gradient_tolerance = options.gradient_tolerance;
  system.evaluate(0);
  state_ = system.state();
  describe_energies(terms);
  return found.stop;
}

void RelaxationRun::describe_energies(const Terms& terms) {
  result_.host.terms.clear();
  for (const auto& term : terms) {
    numerics::EnergySum own;
    term->add(state_, 0, own);
    if (term == terms.back()) {
      result_.network_energy = own.value;
    } else {
      result_.host.terms.push_back({std::string(term->name()), own.value});
    }
  }
}

void RelaxationRun::refuse_collapsed(const NetworkState& state) const {
  const GeodesicElements elements(solver_, network_, points_.held, {});
  Faults faults;
  for (std::size_t t = 0; t < network_.triangles.size(); ++t)
    if (!std::isfinite(elements.energy_of(t).at(elements.lengths_of(*state.found(), t)).energy))
      faults.add("triangles/" + std::to_string(t), "has no area where its corners are");
  faults.throw_if_any("network.collapsed");
}

}  // namespace supple::embedded
