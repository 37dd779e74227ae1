#include "supple/surface/karcher_mean.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <utility>

#include "anchor_distances.h"
#include "karcher_vertex_search.h"
#include "squared_distances.h"
#include "supple/base/error.h"
#include "supple/base/number_text.h"
#include "supple/numerics/minimizer.h"
#include "supple/surface/exponential_map.h"
#include "supple/surface/vertex_cone.h"

namespace supple::surface {
namespace {

KarcherTermination termination_of(numerics::MinimizerTermination termination) {
  switch (termination) {
    case numerics::MinimizerTermination::converged:
      return KarcherTermination::converged;
    case numerics::MinimizerTermination::iteration_limit:
      return KarcherTermination::iteration_limit;
    default:
      return KarcherTermination::step_too_small;
  }
}

/// Expected number of positions at which a mean evaluates distances after its start, by method. The choice of the
/// search uses them. They are rounded means over the benchmark's meshes (docs/bench/karcher.md).
constexpr std::int64_t expected_evaluations_newton = 9;
constexpr std::int64_t expected_evaluations_lbfgs = 12;
constexpr std::int64_t expected_evaluations_descent = 15;

/// Maximum number of points that are compared as starts.
constexpr std::size_t max_start_candidates = 5;

/// Steps shorter than this fraction of the mesh diagonal do not move a point in double precision.
constexpr double min_step = 1e-16;
/// Derivatives are exact, so a line search succeeds after a few backtracks unless the state is at a kink. The minimizer
/// tries kinks separately (KarcherVertexSearch).
constexpr int max_backtracks = 30;
/// Regularization, in multiples of the Hessian's scale, at which a step is a thousandth of the Newton step.
constexpr double max_regularization = 1e3;

/// If the minimizer ends at a kink, near a cut locus or because it finds no step, the objective E (SquaredDistances) is
/// probed in this many directions, at this fraction of the mean edge length. That is near enough to show the slope of a
/// kink, and far enough for the slope to exceed rounding.
constexpr int probe_directions = 16;
constexpr double probe_radius = 1e-3;
/// A probe counts as lower if it decreases E by more than this fraction, which is well above E's rounding.
constexpr double min_probe_decrease = 1e-12;
constexpr int max_probes = 20;

struct Problem {
  std::vector<SurfacePoint> anchors;  ///< those of positive weight
  std::vector<double> weights;        ///< scaled to the sum 1
  std::optional<SurfacePoint> start;
};

std::vector<double> checked_weights(const KarcherProblem& problem) {
  const std::size_t n = problem.points.size();
  if (problem.weights.empty()) return std::vector<double>(n, 1.0 / static_cast<double>(n));
  if (problem.weights.size() != n)
    throw Error(
        "karcher.weights", "There must be one weight for each point, or none.",
        {{"weights", std::to_string(problem.weights.size()) + " weights for " + std::to_string(n) + " points"}});
  std::vector<Error::Detail> faults;
  for (std::size_t i = 0; i < n; ++i) {
    const std::string where = "weights/" + std::to_string(i);
    if (!std::isfinite(problem.weights[i]))
      faults.push_back({where, "is not finite"});
    else if (problem.weights[i] < 0)
      faults.push_back({where, "is negative"});
  }
  if (!faults.empty()) throw Error("karcher.weights", "Weights must be finite and not negative.", std::move(faults));
  // Dividing by the largest weight first prevents overflow and underflow of the sum.
  const double largest = *std::ranges::max_element(problem.weights);
  if (!(largest > 0))
    throw Error("karcher.weights", "At least one weight must be positive.", {{"weights", "are all zero"}});
  std::vector<double> weights = problem.weights;
  for (double& w : weights) w /= largest;
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& w : weights) w /= sum;
  return weights;
}

void check_options(const KarcherProblem& problem) {
  if (!std::isfinite(problem.tolerance) || problem.tolerance < 0)
    throw Error("karcher.invalid_option", "The tolerance must be finite and not negative.",
                {{"tolerance", "is " + number_text(problem.tolerance)}});
  if (problem.max_iterations < 0)
    throw Error("karcher.invalid_option", "The number of iterations must not be negative.",
                {{"max_iterations", "is " + std::to_string(problem.max_iterations)}});
  if (problem.starts < 1)
    throw Error("karcher.invalid_option", "There must be at least one start.",
                {{"starts", "is " + std::to_string(problem.starts)}});
}

Problem checked(const TriangleMesh& mesh, const KarcherProblem& problem) {
  check_options(problem);
  if (problem.points.empty())
    throw Error("karcher.no_points", "A mean needs at least one point.", {{"points", "is empty"}});
  const std::vector<double> weights = checked_weights(problem);

  Problem result;
  std::int32_t component = -1;
  std::vector<Error::Detail> unreachable;
  const auto check_component = [&](const SurfacePoint& point, const std::string& where) {
    const std::int32_t point_component = mesh.component(index(point.face));
    if (component < 0) component = point_component;
    if (point_component != component)
      unreachable.push_back({where, "lies on component " + std::to_string(point_component) +
                                        ", points/0 on component " + std::to_string(component)});
  };
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    const std::string where = "points/" + std::to_string(i);
    const SurfacePoint point = checked_point(mesh, problem.points[i], where);
    check_component(point, where);
    if (weights[i] <= 0) continue;
    result.anchors.push_back(point);
    result.weights.push_back(weights[i]);
  }
  if (problem.start) {
    result.start = checked_point(mesh, *problem.start, "start");
    check_component(*result.start, "start");
  }
  if (!unreachable.empty())
    throw Error("karcher.unreachable", "The points lie on different components of the mesh, so they have no mean.",
                std::move(unreachable));
  return result;
}

/// The anchors that are compared as starts. If there are many, they are those nearest in space to the weighted
/// centroid, which have the smallest mean squared straight distance. Computing these needs no search.
std::vector<std::size_t> start_candidates(const TriangleMesh& mesh, const Problem& problem) {
  std::vector<std::size_t> candidates(problem.anchors.size());
  std::iota(candidates.begin(), candidates.end(), std::size_t{0});
  if (candidates.size() <= max_start_candidates) return candidates;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < candidates.size(); ++i) centre += problem.weights[i] * position(mesh, problem.anchors[i]);
  std::vector<double> squared_distances(candidates.size());
  for (const std::size_t i : candidates)
    squared_distances[i] = (position(mesh, problem.anchors[i]) - centre).squaredNorm();
  std::ranges::stable_sort(candidates, {}, [&](std::size_t i) { return squared_distances[i]; });
  candidates.resize(max_start_candidates);
  std::ranges::sort(candidates);
  return candidates;
}

SurfacePoint best_start(AnchorDistances& distances, const TriangleMesh& mesh, const Problem& problem,
                        const Execution& execution) {
  if (problem.anchors.size() == 1) return problem.anchors.front();
  const std::vector<std::size_t> candidates = start_candidates(mesh, problem);
  const auto rows = distances.between(candidates, execution);
  double best = std::numeric_limits<double>::infinity();
  SurfacePoint start = problem.anchors.front();
  for (std::size_t r = 0; r < rows.size(); ++r) {
    double value = 0;
    for (std::size_t i = 0; i < rows[r].size(); ++i) value += problem.weights[i] * rows[r][i] * rows[r][i];
    if (value < best) {
      best = value;
      start = problem.anchors[candidates[r]];
    }
  }
  return start;
}

/// Finds vertices of one component that are far in space from all excluded positions. O(vertices) for each position and
/// each vertex found.
class FarVertices {
 public:
  FarVertices(const TriangleMesh& mesh, std::int32_t component)
      : mesh_(mesh), nearest_(static_cast<std::size_t>(mesh.vertex_count()), std::numeric_limits<double>::infinity()) {
    for (std::int32_t v = 0; v < mesh.vertex_count(); ++v)
      if (mesh.component(index(vertex_point(mesh, VertexId{v}).face)) != component)
        nearest_[static_cast<std::size_t>(v)] = -1;
  }
  void exclude(const Eigen::Vector3d& position) {
    for (std::size_t v = 0; v < nearest_.size(); ++v)
      nearest_[v] = std::min(nearest_[v], (mesh_.positions()[v] - position).squaredNorm());
  }
  SurfacePoint farthest() const {
    const auto v = static_cast<std::int32_t>(std::ranges::max_element(nearest_) - nearest_.begin());
    return vertex_point(mesh_, VertexId{v});
  }

 private:
  const TriangleMesh& mesh_;
  std::vector<double> nearest_;  ///< squared distance to the nearest excluded position; -1 on other components
};

std::int64_t expected_evaluations(MinimizationMethod method) {
  switch (method) {
    case MinimizationMethod::newton:
      return expected_evaluations_newton;
    case MinimizationMethod::lbfgs:
      return expected_evaluations_lbfgs;
    case MinimizationMethod::gradient_descent:
      break;
  }
  return expected_evaluations_descent;
}

/// Chooses the search for distances by the request or by the windows counted so far, and bills the reason.
void choose_search(AnchorDistances& distances, const KarcherProblem& problem, const Execution& execution) {
  const AnchorSearchFacts facts = distances.facts(problem.starts * expected_evaluations(problem.method));
  AnchorSearchChoice choice = cheapest_search(facts);
  if (problem.kept_fields == KarcherProblem::KeptFields::on) choice = {AnchorSearch::fields, "asked for"};
  if (problem.kept_fields == KarcherProblem::KeptFields::off) {
    const bool pairs_were_searched = facts.windows_per_pair > 0;
    choice = {pairs_were_searched ? AnchorSearch::pairs : AnchorSearch::one_to_many, "asked not to"};
  }
  const bool stores_fields = choice.search == AnchorSearch::fields;
  const bool guided = choice.search == AnchorSearch::guided;
  if (execution.cost)
    execution.cost->add_effect("kept_fields", stores_fields, choice.why, stores_fields ? facts.anchors : 0);
  if (execution.cost)
    execution.cost->add_effect(
        "guided_searches", guided,
        guided ? choice.why : "straight distances lead the searches well enough, or fields are kept");
  distances.use(choice.search, execution);
}

numerics::MinimizerOptions minimizer_options(const KarcherProblem& problem, double diagonal) {
  numerics::MinimizerOptions options;
  switch (problem.method) {
    case MinimizationMethod::newton:
      options.method = numerics::MinimizerMethod::newton;
      break;
    case MinimizationMethod::lbfgs:
      options.method = numerics::MinimizerMethod::lbfgs;
      break;
    case MinimizationMethod::gradient_descent:
      options.method = numerics::MinimizerMethod::gradient_descent;
      break;
  }
  options.gradient_tolerance = problem.tolerance * diagonal;
  options.step_tolerance = min_step * diagonal;
  options.max_backtracks = max_backtracks;
  options.max_regularization = max_regularization;
  return options;
}

/// Evenly distributed directions around a point. Each consists of the point in the face that the direction enters, and
/// a unit vector in that face.
std::vector<VertexCone::Direction> spread_directions(const TriangleMesh& mesh, const SurfacePoint& point) {
  std::vector<VertexCone::Direction> directions;
  const int corner = corner_of(point);
  if (corner >= 0) {
    const VertexCone cone(mesh, mesh.faces()[index(point.face)][corner]);
    // The directions are half a spacing from the ends, so that none runs along the boundary at a boundary vertex.
    for (int k = 0; k < probe_directions; ++k)
      directions.push_back(cone.direction((k + 0.5) / probe_directions * cone.total_angle()));
    return directions;
  }
  const auto frame = tangent_frame(mesh, point.face);
  for (int k = 0; k < probe_directions; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.5) / probe_directions;
    directions.push_back({point, frame * Eigen::Vector2d(std::cos(angle), std::sin(angle))});
  }
  return directions;
}

class Search {
 public:
  Search(const TriangleMesh& mesh, const KarcherProblem& problem, AnchorDistances& distances,
         const std::vector<double>& weights, const SurfacePoint& start, const Execution& execution)
      : mesh_(mesh),
        term_(std::make_shared<SquaredDistances>(mesh, distances, weights)),
        // The order is 2 at least, because derivatives are computed together with the distances.
        system_(KarcherState(mesh, start), {term_}, numerics::Unknowns(2), {.execution = execution, .min_order = 2},
                std::make_shared<KarcherVertexSearch>(mesh)),
        options_(minimizer_options(problem, mesh_.diagonal())),
        max_iterations_(problem.max_iterations),
        execution_(execution) {}

  KarcherMean run() {
    numerics::MinimizerTermination stop{};
    for (int probes = 0;; ++probes) {
      options_.max_iterations = max_iterations_ - mean_.iterations;
      const numerics::MinimizerResult result = numerics::minimize(system_, options_, execution_);
      append(result);
      stop = result.stop;
      // A point next to this one can be lower only at a cut locus, at the tip of a cone, or if no step was found.
      if (stop == numerics::MinimizerTermination::iteration_limit || probes == max_probes ||
          mean_.iterations >= max_iterations_)
        break;
      if (stop == numerics::MinimizerTermination::converged && !is_at_kink(evaluated_state()) &&
          away_from_cut_loci(evaluated_state()))
        break;
      if (!probe()) break;
    }
    mean_.mean = system_.state().point();
    mean_.position = position(mesh_, mean_.mean);
    mean_.objective = mean_.history.back().objective;
    mean_.gradient_norm = mean_.history.back().gradient_norm;
    const bool kink = stop == numerics::MinimizerTermination::converged && is_at_kink(evaluated_state());
    mean_.stopped = kink ? KarcherTermination::kink : termination_of(stop);
    return std::move(mean_);
  }

  /// Evaluates the current state. Later evaluations of it cost nothing.
  void evaluate() { system_.evaluate(2); }

 private:
  /// The current state, with its distances.
  const KarcherState& evaluated_state() {
    evaluate();
    return system_.state();
  }

  void append(const numerics::MinimizerResult& result) {
    // After a probe, the first state is the one to which the probe moved. It counts as an iteration with the probe's
    // length.
    const bool probed = !mean_.history.empty();
    mean_.iterations += result.iterations + (probed ? 1 : 0);
    for (const numerics::MinimizerStep& step : result.history)
      mean_.history.push_back({step.value, step.gradient_norm, step.step_length, step.regularization});
    if (probed) mean_.history[mean_.history.size() - result.history.size()].step_length = probe_length();
  }

  double probe_length() const { return probe_radius * mesh_.mean_edge_length(); }

  /// Moves the state to a lower point nearby, if there is one.
  bool probe() {
    double best = mean_.history.back().objective * (1 - min_probe_decrease);
    std::optional<SurfacePoint> lower;
    for (const auto& direction : spread_directions(mesh_, system_.state().point())) {
      const ExponentialMap geodesic =
          exponential_map(mesh_, direction.vertex, probe_length() * direction.vector, execution_.cancellation, false);
      const double value = term_->value_at(geodesic.end, execution_);
      if (value < best) {
        best = value;
        lower = geodesic.end;
      }
    }
    if (lower) system_.set_state(KarcherState(mesh_, *lower));
    return lower.has_value();
  }

  const TriangleMesh& mesh_;
  std::shared_ptr<SquaredDistances> term_;
  numerics::System<KarcherState> system_;
  numerics::MinimizerOptions options_;
  int max_iterations_;
  const Execution& execution_;
  KarcherMean mean_;
};

}  // namespace

KarcherMean karcher_mean(const GeodesicSolver& solver, const KarcherProblem& problem, const Execution& execution) {
  const TriangleMesh& mesh = solver.mesh();
  const Problem checked_problem = checked(mesh, problem);
  execution.checkpoint(0, "search");
  AnchorDistances distances(solver, checked_problem.anchors);
  const SurfacePoint start =
      checked_problem.start ? *checked_problem.start : best_start(distances, mesh, checked_problem, execution);
  // Each of several searches would report its progress from 0 again.
  const Execution search_execution =
      problem.starts == 1 ? execution : Execution{execution.cancellation, nullptr, execution.cost};
  Search search(mesh, problem, distances, checked_problem.weights, start, search_execution);
  // The choice of the search needs the cost of a pair search on this mesh. If none is known yet, the evaluation at the
  // start gives one.
  if (distances.facts(0).windows_per_pair == 0) search.evaluate();
  choose_search(distances, problem, execution);
  KarcherMean mean = search.run();
  if (problem.starts > 1) {
    FarVertices far_vertices(mesh, mesh.component(index(start.face)));
    far_vertices.exclude(position(mesh, start));
    far_vertices.exclude(mean.position);
    for (int s = 1; s < problem.starts; ++s) {
      execution.checkpoint(static_cast<double>(s) / problem.starts, "step");
      const SurfacePoint far = far_vertices.farthest();
      KarcherMean other = Search(mesh, problem, distances, checked_problem.weights, far, search_execution).run();
      far_vertices.exclude(position(mesh, far));
      far_vertices.exclude(other.position);
      if (!(other.objective < mean.objective * (1 - min_probe_decrease))) continue;
      mean = std::move(other);
      mean.start = s;
    }
  }
  if (execution.cost)
    execution.cost->add_effect("multi_start", problem.starts > 1,
                               problem.starts > 1 ? "asked for" : "one start was asked for", problem.starts - 1);
  execution.checkpoint(1, "step");
  return mean;
}

std::string_view to_string(KarcherTermination termination) {
  switch (termination) {
    case KarcherTermination::converged:
      return "converged";
    case KarcherTermination::kink:
      return "kink";
    case KarcherTermination::step_too_small:
      return "step_too_small";
    case KarcherTermination::iteration_limit:
      break;
  }
  return "iteration_limit";
}

}  // namespace supple::surface
