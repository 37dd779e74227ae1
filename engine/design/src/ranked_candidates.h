#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

#include "free_parameters.h"
#include "modulus_choice.h"
#include "structure_limits.h"
#include "supple/design/inverse_design.h"

namespace supple::design {

/// Number of samples of each target at which candidates are compared. It is not a multiple of two or three. If it were,
/// evenly spaced directions would give only a few different values for a structure with rotational symmetry by a
/// quarter or a sixth of a turn.
inline constexpr int coarse_samples = 11;

/// The relative root mean square deviation of profiles, one for each target, from the targets. `outlier_threshold` is
/// that of TargetResiduals. Infinite if a value is not finite.
double relative_deviation(const std::vector<SampledTarget>& targets, const std::vector<double>& weights,
                          double outlier_threshold, const std::vector<Eigen::VectorXd>& profiles);

/// The candidates of a search, each in one or several orientations, ranked by their deviation from the targets. They
/// are evaluated when they are first needed.
class RankedCandidates {
 public:
  /// The problem of a search. It must outlive the candidates.
  struct Problem {
    const DesignSpace& space;
    const DesignOptions& options;
    const FreeParameters& bounds;
    const std::vector<SampledTarget>& targets;
    const std::vector<double>& weights;
    const ModulusChoice& moduli;
    const LimitResiduals& limits;
  };
  explicit RankedCandidates(const Problem& problem) : problem_(problem) {}

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

  Problem problem_;
  std::vector<SampledTarget> coarse_;
  /// Its rows are the samples in the first orientation, then those in the next one.
  std::shared_ptr<const Candidates::Table> table_;
  std::vector<double> orientations_;
};

}  // namespace supple::design
