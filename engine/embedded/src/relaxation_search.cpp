// The search for an equilibrium, which all phases use.
#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "euclidean_springs.h"
#include "network_energy.h"
#include "relaxation_phases.h"
#include "supple/base/faults.h"

namespace supple::embedded {
namespace {

/// Steps shorter than this, in mesh diagonals, do not move a point in double precision.
constexpr double min_step = 1e-16;
constexpr int max_backtracks_of_a_step = 40;
/// Steps along directions of negative curvature are doubled up to this factor.
constexpr double max_expansion = 64;
/// Rounding of a host's gradient, relative to its stiffness times the mesh diagonal. Where the network is so much
/// weaker than its host, this is the tolerance.
constexpr double host_gradient_rounding = 1e-14;
/// Relative rounding of the energy of a host with small strains.
constexpr double host_value_rounding = 1e-12;
/// A step that lowers the energy by less than this fraction of what its slope promises goes to and fro across a kink.
constexpr double stagnation_fraction = 1e-3;

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

void refuse_collapsed_triangles(const ElasticNetwork& elements, const NetworkState& state) {
  Faults faults;
  for (std::size_t t = 0; t < elements.triangles().size(); ++t)
    if (!std::isfinite(elements.triangles()[t].energy.at(elements.side_lengths(*state.found(), t)).energy))
      faults.add("triangles/" + std::to_string(t), "has no area where its corners are");
  faults.throw_if_any("network.collapsed");
}

/// The gradient norm of a state whose paths are found, by all points and nodes that are free in the answer.
double gradient_norm_at(const RelaxationContext& context, NetworkState state) {
  const auto elements = std::make_shared<NetworkEnergy>(context.solver, context.elements, PathCacheOptions{});
  elements->redistribute_path_forces(state);
  numerics::System<NetworkState>::Terms terms = context.host.terms();
  terms.push_back(elements);
  numerics::System<NetworkState> system(std::move(state), std::move(terms),
                                        numerics::Unknowns(context.fixed_degrees(context.points.fixed)),
                                        {.execution = context.execution});
  return system.evaluate(1).gradient.norm();
}

}  // namespace

RelaxationContext::RelaxationContext(const surface::GeodesicSolver& mesh_solver, const Network& checked_network,
                                     const RelaxationOptions& relaxation_options, const Execution& whole_execution)
    : solver(mesh_solver),
      network(checked_network),
      options(relaxation_options),
      execution(whole_execution),
      points(constrained_points(network)),
      elements(std::make_shared<const ElasticNetwork>(network, points.fixed)),
      host(solver.mesh(), options.host, execution) {}

bool RelaxationContext::is_rigid() const { return std::holds_alternative<RigidHost>(options.host); }

NetworkSearch::Options RelaxationContext::search_options(bool is_mollified) const {
  return {.paths = {.reuses_strips = reuses_strips(), .mollifier_length = is_mollified ? options.mollifier_length : 0}};
}

numerics::MinimizerOptions RelaxationContext::minimizer_options() const {
  const double diagonal = solver.mesh().diagonal();
  numerics::MinimizerOptions minimizer;
  minimizer.method = minimizer_method(options.method);
  minimizer.gradient_tolerance =
      std::max(options.tolerance * largest_weight(network), host_gradient_rounding * host.stiffness()) * diagonal;
  minimizer.step_tolerance = min_step * diagonal;
  minimizer.max_backtracks = max_backtracks_of_a_step;
  minimizer.max_expansion = max_expansion;
  minimizer.stagnation_fraction = stagnation_fraction;
  if (host.is_deformable()) minimizer.value_rounding = host_value_rounding;
  // Without curvature the first step is that of a single point whose neighbours stay in place.
  if (const double stiffness = std::max(points.max_stiffness, host.stiffness()); stiffness > 0)
    minimizer.first_step = 1 / stiffness;
  return minimizer;
}

std::vector<bool> RelaxationContext::fixed_degrees(const std::vector<bool>& fixed_points) const {
  std::vector<bool> coordinates = fixed_coordinates(fixed_points);
  coordinates.insert(coordinates.end(), host.fixed().begin(), host.fixed().end());
  return coordinates;
}

void RelaxationHistory::record(const numerics::MinimizerStep& step, const NetworkState& state, bool fixes_more) {
  // Memory may be refused for the copy: then neither the steps nor the state have changed.
  std::optional<NetworkState> copy;
  if (keeps_state_) copy = state;
  steps_.push_back({step.value, step.gradient_norm, step.step_length, step.regularization});
  if (copy) state_ = std::move(copy);
  fixes_more_ = fixes_more;
  if (options_.observer) options_.observer(steps_.back(), state.points(), state.mesh());
}

Equilibrium start_of(const RelaxationContext& context) {
  if (!context.host.is_deformable()) return {.state = {context.solver.mesh(), context.network.points}};
  // The solver belongs to the caller.
  return {.state = {std::shared_ptr<const surface::GeodesicSolver>(std::shared_ptr<void>(), &context.solver),
                    context.network.points, context.host.nodes()}};
}

Equilibrium find_equilibrium(const RelaxationContext& context, const Equilibrium& from, const SearchSettings& settings,
                             RelaxationHistory& history, const Execution& execution) {
  const surface::GeodesicSolver& solver = from.solver(context.solver);
  // A later search counts its start as an iteration, because the history has an entry for it.
  const int first_iteration = history.empty() ? 0 : 1;
  const std::vector<bool>& fixed = settings.fixed_points ? *settings.fixed_points : context.points.fixed;
  NetworkTerm term;
  if (context.follows_geodesics()) {
    const auto elements =
        settings.fixed_points ? std::make_shared<const ElasticNetwork>(context.network, fixed) : context.elements;
    term = network_term(from.moved_surface ? *from.moved_surface : context.solver, elements,
                        context.search_options(settings.is_mollified));
  }
  // The network comes last in the sum: where its paths lead over other faces, only its own entries of the Hessian are
  // new.
  numerics::System<NetworkState>::Terms terms = context.host.terms();
  if (term.energy) {
    terms.push_back(term.energy);
  } else {
    terms.push_back(std::make_shared<EuclideanSprings>(context.network));
  }
  NetworkState start = context.host.is_deformable() ? from.state : NetworkState(solver.mesh(), from.state.points());
  numerics::System<NetworkState> system(std::move(start), std::move(terms),
                                        numerics::Unknowns(context.fixed_degrees(fixed)),
                                        {.execution = context.execution}, term.search);
  if (!context.network.triangles.empty() && !std::isfinite(system.evaluate(0).value))
    refuse_collapsed_triangles(*context.elements, system.state());
  numerics::MinimizerOptions options = context.minimizer_options();
  options.max_iterations = std::max(0, settings.max_iterations - from.iterations - first_iteration);
  const bool fixes_more = settings.fixed_points != nullptr;
  options.after_step = [&](const numerics::MinimizerStep& step) { history.record(step, system.state(), fixes_more); };
  const numerics::MinimizerResult found = numerics::minimize(system, options, execution);
  return {.state = system.prepared_state(),
          .moved_surface = from.moved_surface,
          .termination = found.stop,
          .energy = found.value,
          .gradient_norm = found.gradient_norm,
          .iterations = from.iterations + found.iterations + first_iteration};
}

Equilibrium best_of(const RelaxationContext& context, const RelaxationHistory& history) {
  const NetworkState& state = *history.state();
  const bool counts_all = !history.fixes_more() || !state.found();
  return {.state = state,
          .termination = numerics::MinimizerTermination::iteration_limit,
          .energy = history.last().energy,
          .gradient_norm = counts_all ? history.last().gradient_norm : gradient_norm_at(context, state),
          .iterations = static_cast<int>(history.size()) - 1};
}

}  // namespace supple::embedded
