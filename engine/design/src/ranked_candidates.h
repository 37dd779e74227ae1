#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

#include "search_problem.h"

namespace supple::design {

/// The relative root mean square deviation of profiles, one for each target, from the targets. `outlier_threshold` is
/// that of TargetResiduals. Infinite if a value is not finite.
double relative_deviation(const std::vector<SampledTarget>& targets, const std::vector<double>& weights,
                          double outlier_threshold, const std::vector<Eigen::VectorXd>& profiles);

/// The candidates of a search, each in one or several orientations, ranked by their deviation from the targets. They
/// are evaluated when they are first needed.
class RankedCandidates {
 public:
  /// The problem must outlive the candidates.
  explicit RankedCandidates(const SearchProblem& problem) : problem_(problem) {}

  /// The targets with `coarse_samples` samples each.
  const std::vector<SampledTarget>& targets();

  /// Evaluates the candidates at these samples, once. Takes tens of milliseconds for some hundred candidates.
  void evaluate(const Execution& execution);
  bool are_evaluated() const { return table_ != nullptr; }

  // These members need the evaluation. The index of a candidate counts those of the first orientation first.
  Eigen::Index count() const;
  Eigen::VectorXd at(Eigen::Index candidate) const;  ///< all parameters
  /// Values at the samples of all targets, one target after the other.
  Eigen::VectorXd values(Eigen::Index candidate) const;
  /// Errors and candidates, ordered by increasing error. The error is the deviation at the best modulus, with
  /// `outlier_threshold`, combined with the penalty for violated limits.
  std::vector<std::pair<double, Eigen::Index>> ranked(double outlier_threshold) const;

 private:
  double error(Eigen::Index candidate, double outlier_threshold) const;
  std::vector<double> orientations() const;

  const SearchProblem& problem_;
  std::vector<SampledTarget> coarse_;
  /// Its rows are the samples in the first orientation, then those in the next one.
  std::shared_ptr<const Candidates::Table> table_;
  std::vector<double> orientations_;
};

}  // namespace supple::design
