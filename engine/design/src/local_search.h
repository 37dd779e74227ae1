#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "best_design.h"
#include "ranked_candidates.h"
#include "search_problem.h"

namespace supple::design {

/// Searches from single starting points, each for a minimum of the deviation nearby, and hands their ends to the best
/// design. Targets with many samples are first optimized with a few of them, which finds the neighbourhood of a minimum
/// at a fraction of the cost.
class LocalSearch {
 public:
  /// The arguments must outlive the object.
  LocalSearch(const SearchProblem& problem, RankedCandidates& candidates, BestDesign& best, SearchCounts& counts,
              const Execution& execution, const OnProgress& progress);

  /// Optimizes from one starting point (all parameters). It uses all samples at once if the point is near the targets.
  void search_from(const Eigen::VectorXd& start);

  /// The end of a search with few samples.
  struct CoarseMinimum {
    double deviation = 0;          ///< deviation at these samples, with `outlier_threshold`; infinite if undefined
    double outlier_threshold = 0;  ///< for the search with all samples
    Eigen::VectorXd x;
  };
  /// Optimizes from one starting point with few samples. None if the search has no equilibrium. `outlier_threshold` is
  /// that of TargetResiduals.
  std::optional<CoarseMinimum> coarse_minimum(const Eigen::VectorXd& start, double outlier_threshold);

  /// Optimizes the free parameters with all samples. If `outlier_threshold` is positive, a search with reduced outliers
  /// comes first.
  void refine(Eigen::VectorXd x, double outlier_threshold = 0);

  /// Compares the best state of all searches, so that it is not lost where they are stopped. Returns whether there is a
  /// design.
  bool keep_best_state();

  /// Values of each target at the first starting point.
  const std::vector<Eigen::VectorXd>& initial_profiles() const { return initial_; }

 private:
  double evaluate_start(const Eigen::VectorXd& start);
  numerics::LeastSquaresResult rough_search(const std::vector<SampledTarget>& targets, const Eigen::VectorXd& x,
                                            int iterations, double outlier_threshold);
  numerics::LeastSquaresResult optimize(const std::vector<SampledTarget>& targets, const Eigen::VectorXd& x,
                                        const numerics::LeastSquaresOptions& options, double outlier_threshold = 0);
  void report(const TargetResiduals& residuals, const std::vector<SampledTarget>& targets, const Eigen::VectorXd& x,
              double norm, int iteration);

  const SearchProblem& problem_;
  RankedCandidates& candidates_;
  BestDesign& best_;
  SearchCounts& counts_;
  const Execution& execution_;
  const OnProgress& progress_;
  std::vector<Eigen::VectorXd> initial_;
  std::optional<double> min_reported_deviation_;
  /// The free parameters of the best state, and its deviation with the penalties for violated limits.
  Eigen::VectorXd best_state_;
  double best_norm_ = std::numeric_limits<double>::infinity();
};

}  // namespace supple::design
