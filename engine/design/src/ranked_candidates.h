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

/// Samples of each target by which candidates are compared. Not a multiple of two or three: of a structure that looks
/// the same after a quarter or a sixth of a turn, evenly spread directions would be few different ones.
inline constexpr int coarse_samples = 11;

/// The relative root mean square deviation of profiles, one for each target, from the targets, for `outlier` as in
/// TargetResiduals. It is infinite where a value is not finite.
double relative_deviation(const std::vector<SampledTarget>& targets, const std::vector<double>& weights, double outlier,
                          const std::vector<Eigen::VectorXd>& profiles);

/// The candidates of a search, each in one or several orientations, and how far they are from its targets. They are
/// evaluated when they are first needed.
class RankedCandidates {
 public:
  /// The problem of a search. All of it outlives the candidates.
  struct Problem {
    const DesignSpace& space;
    const DesignOptions& options;
    const FreeParameters& bounds;
    const std::vector<SampledTarget>& targets;
    const std::vector<double>& weights;
    const ModulusChoice& moduli;
    const LimitRows& limits;
  };
  explicit RankedCandidates(const Problem& problem) : problem_(problem) {}

  /// The targets with `coarse_samples` samples each.
  const std::vector<SampledTarget>& targets();

  /// Evaluates them at these samples, once. Takes tens of milliseconds for some hundred candidates.
  void evaluate(const Execution& execution);
  bool are_evaluated() const { return table_ != nullptr; }

  // Once they are evaluated: those of the first orientation come first.
  Eigen::Index count() const;
  Eigen::VectorXd at(Eigen::Index candidate) const;      ///< all parameters
  Eigen::VectorXd values(Eigen::Index candidate) const;  ///< at the samples of all targets, one after the other
  /// Errors and candidates, the best first. An error is the deviation with the best modulus, for `outlier`, and what is
  /// beyond the limits as searches count it.
  std::vector<std::pair<double, Eigen::Index>> ranked(double outlier) const;

 private:
  double error(Eigen::Index candidate, double outlier) const;
  std::vector<double> orientations() const;

  Problem problem_;
  std::vector<SampledTarget> coarse_;
  std::shared_ptr<const Candidates::Table> table_;  ///< its samples are those of the first orientation, then the next
  std::vector<double> orientations_;
};

}  // namespace supple::design
