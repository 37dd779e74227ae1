#include "supple/voronoi/optimization.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "objectives.h"
#include "site_moves.h"
#include "supple/base/best_so_far.h"
#include "supple/base/error.h"
#include "supple/numerics/minimizer.h"
#include "supple/numerics/system.h"

namespace supple::voronoi {
namespace {

OptimizationTermination termination_of(numerics::MinimizerTermination termination) {
  switch (termination) {
    case numerics::MinimizerTermination::converged:
      return OptimizationTermination::converged;
    case numerics::MinimizerTermination::iteration_limit:
      return OptimizationTermination::iteration_limit;
    default:
      return OptimizationTermination::step_too_small;
  }
}

void check(const OptimizationOptions& options, std::size_t sites) {
  std::vector<Error::Detail> faults;
  const ObjectiveWeights& w = options.weights;
  const std::pair<const char*, double> weights[] = {{"edge_length", w.edge_length},
                                                    {"planarity", w.planarity},
                                                    {"regularity", w.regularity},
                                                    {"centroidal", w.centroidal},
                                                    {"equal_area", w.equal_area}};
  bool any = false;
  for (const auto& [name, weight] : weights) {
    if (!(weight >= 0 && std::isfinite(weight)))
      faults.push_back({std::string("objectives/") + name, "must be finite and not negative"});
    any = any || weight > 0;
  }
  if (!(options.tolerance > 0)) faults.push_back({"tolerance", "must be above 0"});
  if (!(options.border_deviation >= min_border_deviation && options.border_deviation <= 1))
    faults.push_back({"border_deviation", "must be from 1e-7 to 1"});
  if (options.max_iterations < 0 || options.max_iterations > max_optimization_iterations)
    faults.push_back({"max_iterations", "is " + std::to_string(options.max_iterations) + ", but must be from 0 to " +
                                            std::to_string(max_optimization_iterations)});
  if (!(options.edge_length >= 0 && std::isfinite(options.edge_length)))
    faults.push_back({"edge_length", "must be finite and not negative"});
  if (!faults.empty())
    throw Error("voronoi.invalid_option", "An option of the optimization is out of its range.", std::move(faults));
  if (!any)
    throw Error("voronoi.no_objective", "An optimization needs an objective of positive weight.",
                {{"objectives", "all weights are 0"}});
  for (std::size_t i = 0; i < options.fixed_sites.size(); ++i) {
    const std::int32_t site = options.fixed_sites[i];
    if (site < 0 || static_cast<std::size_t>(site) >= sites)
      throw Error("voronoi.fixed_site", "A site to be held does not exist.",
                  {{"fixed_sites/" + std::to_string(i),
                    "is " + std::to_string(site) + ", the sites are 0 to " + std::to_string(sites - 1)}});
  }
}

/// Curvature condition of the line search: the slope at the end of a step relative to that at its start.
constexpr double max_slope_ratio = 0.9;

/// Whether steps use Gauss-Newton Hessians: by default only for equal areas alone. The residuals of no other objective
/// can nearly vanish, and with them the terms that these Hessians neglect.
bool uses_gauss_newton(const OptimizationOptions& options) {
  const ObjectiveWeights& w = options.weights;
  if (options.method != OptimizationMethod::automatic) return options.method == OptimizationMethod::gauss_newton;
  return !(w.edge_length + w.planarity + w.regularity + w.centroidal > 0);
}

DiagramStatistics::Spread spread_of(const std::vector<double>& values) {
  DiagramStatistics::Spread spread;
  if (values.empty()) return spread;
  spread.least = *std::min_element(values.begin(), values.end());
  spread.greatest = *std::max_element(values.begin(), values.end());
  for (const double value : values) spread.mean += value;
  spread.mean /= static_cast<double>(values.size());
  for (const double value : values) spread.deviation += (value - spread.mean) * (value - spread.mean);
  spread.deviation = std::sqrt(spread.deviation / static_cast<double>(values.size()));
  return spread;
}

}  // namespace

namespace {

/// `lengths` are the geodesics between the vertices of all edges that have two.
DiagramStatistics statistics_of(const Diagram& diagram, const std::vector<surface::TangentGeodesic>& lengths) {
  DiagramStatistics result;
  std::vector<double> values;
  values.reserve(lengths.size());
  for (const surface::TangentGeodesic& length : lengths) values.push_back(length.distance);
  result.edge_length = spread_of(values);
  values.clear();
  std::vector<double> ratios;
  std::vector<double> areas;
  for (const DiagramCell& cell : diagram.cells) {
    areas.push_back(cell.area);
    if (cell.vertices.empty()) continue;
    const FittedPlane plane = fit_plane(vertex_positions(diagram, cell));
    for (Eigen::Index j = 0; j < plane.distances.size(); ++j) values.push_back(std::abs(plane.distances[j]));
    double mean = 0;
    std::vector<double> distances;
    for (const std::int32_t vertex : cell.vertices) {
      const auto point = static_cast<std::size_t>(diagram.vertices[static_cast<std::size_t>(vertex)].point);
      distances.push_back(diagram.points[point].distance);
      mean += distances.back() / static_cast<double>(cell.vertices.size());
    }
    for (const double distance : distances)
      if (mean > 0) ratios.push_back(distance / mean);
  }
  result.planarity = spread_of(values);
  result.area = spread_of(areas);
  result.vertex_distance = spread_of(ratios);
  return result;
}

}  // namespace

DiagramStatistics statistics(const surface::GeodesicSolver& solver, const Diagram& diagram,
                             const Execution& execution) {
  std::vector<std::int32_t> edges;
  return statistics_of(diagram, measure_edges(solver, diagram, edges, execution));
}

namespace {

/// The quantities that the values of the objectives need and, with `derivatives`, their gradients.
RequiredQuantities quantities_of(const OptimizationOptions& options, bool derivatives) {
  const ObjectiveWeights& w = options.weights;
  return {.edge_lengths = w.edge_length > 0,
          .motions = derivatives && w.edge_length + w.planarity + w.regularity > 0,
          .border_gradients = derivatives && w.equal_area > 0,
          .cell_moments = w.centroidal > 0,
          .border_deviation = options.border_deviation};
}

using DiagramTerms = std::vector<std::shared_ptr<DiagramTerm>>;

/// `length` is the target length of edges.
DiagramTerms terms_of(const std::shared_ptr<const DiagramEvaluator>& evaluator, const ObjectiveWeights& w, double unit,
                      double length) {
  DiagramTerms terms;
  if (w.edge_length > 0) terms.push_back(std::make_shared<EdgeLengthTerm>(evaluator, w.edge_length, unit, length));
  if (w.planarity > 0) terms.push_back(std::make_shared<PlanarityTerm>(evaluator, w.planarity, unit));
  if (w.regularity > 0) terms.push_back(std::make_shared<RegularityTerm>(evaluator, w.regularity, unit));
  if (w.centroidal > 0) terms.push_back(std::make_shared<CentroidalTerm>(evaluator, w.centroidal, unit));
  if (w.equal_area > 0) terms.push_back(std::make_shared<EqualAreaTerm>(evaluator, w.equal_area, unit));
  return terms;
}

/// A site is steep if the norm of its gradient is more than this many times the median.
constexpr double min_steep_ratio = 10;
constexpr int max_iterations_without_steep_sites = 50;
/// If the other sites lower the energy by more than this fraction, single-site moves are postponed.
constexpr double large_gain_without_steep_sites = 0.02;

/// The search for a minimum: steps for all sites, and single-site moves if these no longer lower the energy.
class Search {
 public:
  Search(const OptimizationOptions& options, numerics::System<SitesState>& system, std::vector<bool> fixed,
         numerics::MinimizerOptions minimizer, SiteMoves moves, const Execution& execution, Optimization& result)
      : options_(options),
        system_(system),
        fixed_(std::move(fixed)),
        minimizer_(std::move(minimizer)),
        moves_(std::move(moves)),
        execution_(execution),
        result_(result) {}

  /// Searches until it ends by itself, or until it is stopped once a state is known that it can answer with.
  void run() {
    const StopReason reason = search_until_stopped(
        execution_.cancellation, [&] { return best_.has_value(); }, [&] { search(); });
    if (reason != StopReason::none) take_best(reason);
  }

 private:
  void search() {
    using Termination = numerics::MinimizerTermination;
    Termination termination = minimize(0);
    while (termination == Termination::step_too_small) {
      if (result_.iterations >= options_.max_iterations || result_.site_moves.passes >= max_site_move_passes) {
        termination = Termination::iteration_limit;
        break;
      }
      const double before = result_.energy;
      if (result_.site_moves.held_searches++ == 0) result_.site_moves.energy_before = before;
      const double step_length = minimize_without_steep_sites();
      if (before - result_.energy > large_gain_without_steep_sites * before) {
        termination = minimize(step_length);
        continue;
      }
      const SiteMovesPass pass = move_single_sites();
      if (pass.taken == 0 && !(result_.energy < before)) break;
      termination = minimize(std::hypot(step_length, pass.step_length));
      if (pass.complete && before - result_.energy <= min_pass_gain * before) break;
    }
    result_.stopped = termination_of(termination);
  }

  /// Makes the last state of the history the result, after the search was stopped at another one.
  void take_best(StopReason reason) {
    system_.set_state(std::move(*best_));
    result_.energy = result_.history.back().energy;
    result_.gradient_norm = result_.history.back().gradient_norm;
    result_.iterations = static_cast<int>(result_.history.size()) - 1;
    result_.stopped =
        reason == StopReason::deadline ? OptimizationTermination::deadline : OptimizationTermination::memory;
  }

  /// Minimizes from the present state. `step_length` is that of the steps without steep sites and the single-site moves
  /// that led there, 0 if there were none.
  numerics::MinimizerTermination minimize(double step_length) {
    bool is_start = true;
    if (!result_.history.empty()) ++result_.iterations;
    minimizer_.max_iterations = options_.max_iterations - result_.iterations;
    minimizer_.after_step = [&](const numerics::MinimizerStep& step) {
      auto copy = system_.state();  // first, since memory may be refused for it
      result_.history.push_back({step.value, step.gradient_norm, is_start ? step_length : step.step_length});
      is_start = false;
      best_ = std::move(copy);
      if (options_.observer && system_.state().evaluation())
        options_.observer(result_.history.back(), system_.state().evaluation()->diagram);
    };
    const numerics::MinimizerResult found = numerics::minimize(system_, minimizer_, execution_);
    result_.energy = found.value;
    result_.gradient_norm = found.gradient_norm;
    result_.iterations += found.iterations;
    return found.stop;
  }

  /// Fixes the sites whose gradients are far above the median, and minimizes for the others: at a kink or a jump of the
  /// energy a few sites prevent progress for all. Returns the root of the sum of the squared steps.
  double minimize_without_steep_sites() {
    const Eigen::VectorXd gradient = system_.full_gradient();
    std::vector<double> slopes;
    for (Eigen::Index i = 0; i < gradient.size(); i += 2) slopes.push_back(gradient.segment<2>(i).norm());
    std::vector<double> sorted = slopes;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    std::vector<bool> fixed = fixed_;
    for (std::size_t i = 0; i < slopes.size(); ++i)
      if (slopes[i] > min_steep_ratio * *middle) fixed[2 * i] = fixed[2 * i + 1] = true;
    if (fixed == fixed_ || std::ranges::find(fixed, false) == fixed.end()) return 0;
    numerics::System<SitesState> others(system_.state(), system_.terms(), numerics::Unknowns(fixed),
                                        {.execution = execution_});
    numerics::MinimizerOptions minimizer = minimizer_;
    double squares = 0;
    minimizer.max_iterations = max_iterations_without_steep_sites;
    minimizer.after_step = [&](const numerics::MinimizerStep& step) { squares += step.step_length * step.step_length; };
    result_.energy = numerics::minimize(others, minimizer, execution_).value;
    system_.set_state(others.state());
    return std::sqrt(squares);
  }

  SiteMovesPass move_single_sites() {
    SitesState state = system_.state();
    const SiteMovesPass pass = moves_.pass(state, execution_);
    if (execution_.cost != nullptr) execution_.cost->add_quantity("site_moves", static_cast<double>(pass.tried));
    ++result_.site_moves.passes;
    result_.site_moves.tried += pass.tried;
    result_.site_moves.taken += pass.taken;
    result_.site_moves.last_gain = pass.gain;
    if (pass.taken > 0) system_.set_state(std::move(state));
    return pass;
  }

  const OptimizationOptions& options_;
  numerics::System<SitesState>& system_;
  std::vector<bool> fixed_;  ///< two degrees of freedom for each site
  numerics::MinimizerOptions minimizer_;
  SiteMoves moves_;
  const Execution& execution_;
  Optimization& result_;
  std::optional<SitesState> best_;  ///< the last state of the history, with its diagram
};

/// The sentence that warns of a search that was stopped; empty for the others.
std::string warning_of(const Optimization& result) {
  if (result.stopped != OptimizationTermination::deadline && result.stopped != OptimizationTermination::memory)
    return {};
  const StopReason reason =
      result.stopped == OptimizationTermination::deadline ? StopReason::deadline : StopReason::memory;
  return stop_sentence(reason, " after " + std::to_string(result.iterations) +
                                   (result.iterations == 1 ? " iteration" : " iterations") +
                                   ": this is the best diagram until then, and its sites are not at rest.");
}

}  // namespace

Optimization optimize(const surface::GeodesicSolver& solver, std::vector<surface::SurfacePoint> sites,
                      const OptimizationOptions& options, const Execution& execution) {
  check(options, sites.size());
  const surface::TriangleMesh& mesh = solver.mesh();
  const auto evaluator = std::make_shared<const DiagramEvaluator>(solver, quantities_of(options, true));
  Execution unreported = execution;
  unreported.progress = nullptr;
  Optimization result;
  Diagram start = diagram(solver, sites, {.border_deviation = options.border_deviation}, unreported);
  result.before = statistics(solver, start, unreported);
  sites = start.sites;
  double area = 0;
  for (const DiagramCell& cell : start.cells) area += cell.area;
  const double unit = std::sqrt(area / static_cast<double>(sites.size()));
  const double length = options.edge_length > 0 ? options.edge_length : result.before.edge_length.mean;

  const DiagramTerms terms = terms_of(evaluator, options.weights, unit, length);
  std::vector<bool> fixed(2 * sites.size(), false);
  for (const std::int32_t site : options.fixed_sites)
    for (std::size_t k = 0; k < 2; ++k) fixed[2 * static_cast<std::size_t>(site) + k] = true;
  const SitesState state(mesh, std::move(sites));
  numerics::System<SitesState> system(state, {terms.begin(), terms.end()}, numerics::Unknowns(fixed),
                                      {.execution = execution});
  numerics::MinimizerOptions minimizer;
  minimizer.method = uses_gauss_newton(options) ? numerics::MinimizerMethod::newton : numerics::MinimizerMethod::lbfgs;
  const auto count = static_cast<double>(system.state().sites().points().size());
  result.gradient_tolerance = options.tolerance * std::sqrt(count) / unit;
  minimizer.gradient_tolerance = result.gradient_tolerance;
  minimizer.step_tolerance = 1e-12 * unit;
  minimizer.first_step = unit * unit;
  // At edges of the mesh the positions of corners in space have kinks, along which minima lie. This condition makes
  // L-BFGS proceed along kinks.
  if (options.weights.planarity > 0) minimizer.slope_contraction = max_slope_ratio;
  SiteMoves moves(std::make_shared<const DiagramEvaluator>(solver, quantities_of(options, false)), terms, fixed, unit);
  Search(options, system, fixed, std::move(minimizer), std::move(moves), execution, result).run();
  SitesState end = system.state();
  evaluator->evaluate(end, 0, unreported);
  for (const auto& term : terms) {
    numerics::EnergySum sum;
    term->add(end, 0, sum);
    result.terms.push_back({std::string(term->name()), sum.value});
  }
  DiagramEvaluation& last = *end.evaluation();
  result.diagram = std::move(last.diagram);
  result.after = options.weights.edge_length > 0 ? statistics_of(result.diagram, last.edge_lengths)
                                                 : statistics(solver, result.diagram, unreported);
  if (std::string warning = warning_of(result); !warning.empty()) result.diagram.warnings.push_back(std::move(warning));
  return result;
}

std::string_view to_string(OptimizationTermination termination) {
  switch (termination) {
    case OptimizationTermination::converged:
      return "converged";
    case OptimizationTermination::step_too_small:
      return "step_too_small";
    case OptimizationTermination::deadline:
      return "deadline";
    case OptimizationTermination::memory:
      return "memory";
    case OptimizationTermination::iteration_limit:
      break;
  }
  return "iteration_limit";
}

}  // namespace supple::voronoi
