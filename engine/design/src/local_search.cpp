#include "local_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace supple::design {
namespace {

/// Relative root mean square deviation up to which a search from the first starting point uses all samples at once.
constexpr double near_deviation = 0.1;
/// Tolerance of searches with few samples.
constexpr double coarse_tolerance = 1e-4;
/// Tolerance of equilibria, as a fraction of the search's tolerance. With less accurate equilibria the search would
/// follow their errors.
constexpr double equilibrium_tolerance_ratio = 1e-2;
/// Maximum deviation, with reduced outliers, of a minimum at which only a few samples are outliers.
constexpr double max_deviation_with_outliers = 0.03;
/// Iterations of the search with few samples from each of several starting points.
constexpr int coarse_iterations = 30;
/// Maximum number of searches from one starting point. Each begins at the end of the one before, with equilibria that
/// are computed anew from rest.
constexpr int max_searches_from_rest = 3;

constexpr double undefined_deviation = std::numeric_limits<double>::infinity();

}  // namespace

LocalSearch::LocalSearch(const SearchProblem& problem, RankedCandidates& candidates, BestDesign& best,
                         SearchCounts& counts, const Execution& execution, const OnProgress& progress)
    : problem_(problem),
      candidates_(candidates),
      best_(best),
      counts_(counts),
      execution_(execution),
      progress_(progress) {}

void LocalSearch::search_from(const Eigen::VectorXd& start) {
  const bool near = evaluate_start(start) <= near_deviation;
  const Eigen::VectorXd x = problem_.bounds.free_part(start);
  const bool coarsely = !near && problem_.has_many_samples() && !problem_.bounds.free.empty();
  refine(coarsely ? rough_search(candidates_.targets(), x, problem_.options.max_iterations, 0).x : x);
}

/// Counts a starting point. The profile of the first one is part of the answer. Returns its relative root mean square
/// deviation, and infinity for the others or if it has no equilibrium.
double LocalSearch::evaluate_start(const Eigen::VectorXd& start) {
  ++counts_.starts;
  if (!initial_.empty()) return undefined_deviation;
  auto residuals = problem_.exact_residuals();
  Eigen::VectorXd r;
  const bool defined = residuals.residuals(problem_.bounds.free_part(start), r);
  for (std::size_t t = 0; t < problem_.targets.size(); ++t) initial_.push_back(residuals.values(t));
  counts_.add(residuals);
  return defined ? r.norm() : undefined_deviation;
}

/// If outliers were reduced and the deviation is still large, many samples are off. There are no outliers then, and the
/// search with all samples uses plain squares.
std::optional<LocalSearch::CoarseMinimum> LocalSearch::coarse_minimum(const Eigen::VectorXd& start,
                                                                      double outlier_threshold) {
  evaluate_start(start);
  const auto result =
      rough_search(candidates_.targets(), problem_.bounds.free_part(start), coarse_iterations, outlier_threshold);
  if (!result.defined) return std::nullopt;
  if (outlier_threshold == 0 || result.norm <= max_deviation_with_outliers)
    return CoarseMinimum{result.norm, outlier_threshold, result.x};
  TargetResiduals residuals = problem_.search_residuals(candidates_.targets(), search_tolerance, 0);
  Eigen::VectorXd r;
  const bool defined = residuals.residuals(result.x, r);
  counts_.add(residuals);
  return CoarseMinimum{defined ? r.norm() : undefined_deviation, 0, result.x};
}

/// If a strain has several equilibria, the search may have followed others than those that are found from rest. Then it
/// is repeated from the latter.
void LocalSearch::refine(Eigen::VectorXd x, double outlier_threshold) {
  if (problem_.bounds.free.empty()) {
    best_.compare(x, DesignTermination::no_free_parameters);
    return;
  }
  const DesignOptions& options = problem_.options;
  if (outlier_threshold > 0) x = rough_search(problem_.targets, x, coarse_iterations, outlier_threshold).x;
  for (int pass = 0; pass < max_searches_from_rest; ++pass) {
    const auto result =
        optimize(problem_.targets, x, {.tolerance = options.tolerance, .max_iterations = options.max_iterations});
    x = result.x;
    if (best_.compare(x, static_cast<DesignTermination>(result.stopped)) <= result.norm + good_deviation) return;
  }
}

/// Optimizes with coarse_tolerance.
numerics::LeastSquaresResult LocalSearch::rough_search(const std::vector<SampledTarget>& targets,
                                                       const Eigen::VectorXd& x, int iterations,
                                                       double outlier_threshold) {
  return optimize(targets, x,
                  {.tolerance = std::max(coarse_tolerance, problem_.options.tolerance),
                   .max_iterations = std::min(iterations, problem_.options.max_iterations)},
                  outlier_threshold);
}

numerics::LeastSquaresResult LocalSearch::optimize(const std::vector<SampledTarget>& targets, const Eigen::VectorXd& x,
                                                   const numerics::LeastSquaresOptions& options,
                                                   double outlier_threshold) {
  const FreeParameters& bounds = problem_.bounds;
  TargetResiduals residuals =
      problem_.search_residuals(targets,
                                std::max(std::min(search_tolerance, equilibrium_tolerance_ratio * options.tolerance),
                                         problem_.options.equilibrium_tolerance),
                                outlier_threshold);
  auto result = numerics::minimize_least_squares(
      residuals, x, bounds.free_part(bounds.lower), bounds.free_part(bounds.upper), options,
      Execution{execution_.cancellation},
      [&](const Eigen::VectorXd& at, double norm, int iteration) { report(residuals, targets, at, norm, iteration); });
  counts_.iterations += result.iterations;
  counts_.add(residuals);
  return result;
}

bool LocalSearch::keep_best_state() {
  if (best_state_.size() > 0) best_.compare(best_state_, DesignTermination::iteration_limit);
  return best_.is_found();
}

void LocalSearch::report(const TargetResiduals& residuals, const std::vector<SampledTarget>& targets,
                         const Eigen::VectorXd& x, double residual_norm, int iteration) {
  if (execution_.progress) {
    const double fraction = static_cast<double>(iteration) / problem_.options.max_iterations;
    execution_.progress->report(std::min(0.99, (counts_.starts - 1 + fraction) / problem_.max_starts()),
                                "optimization");
  }
  // These deviations are complete, also if the search reduces outliers.
  std::vector<Eigen::VectorXd> achieved;
  for (std::size_t t = 0; t < targets.size(); ++t) achieved.push_back(residuals.values(t));
  const double norm = relative_deviation(targets, problem_.weights, 0, achieved);
  if (const double penalized = std::max(norm, residual_norm); penalized < best_norm_) {
    best_norm_ = penalized;
    best_state_ = x;
  }
  if (!progress_ || (min_reported_deviation_ && norm >= *min_reported_deviation_)) return;
  min_reported_deviation_ = norm;
  const Eigen::VectorXd parameters = family_part(residuals.last_parameters());
  const double largest = std::abs(targets[0].deviations(achieved[0])[targets[0].worst_sample(achieved[0])]);
  progress_({0,
             parameters,
             orientation_in(residuals.last_parameters()),
             targets[0].samples,
             achieved[0],
             {norm, largest},
             counts_.iterations + iteration});
}

}  // namespace supple::design
