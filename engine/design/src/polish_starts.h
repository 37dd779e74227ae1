#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "polish_rounds.h"
#include "survey.h"

namespace supple::design {

/// Other minima of the corrected network from which a descent may start, in the order of increasing deviation. They are
/// searched for when the first one is asked for.
class OtherStarts {
 public:
  /// The arguments must outlive the object.
  OtherStarts(const DesignSpace& space, const PolishRounds& rounds) : space_(space), rounds_(rounds) {}

  /// The next start that was not simulated yet, in normalized parameters. None if no start is left, or if the remaining
  /// rounds are for the survey.
  std::optional<Eigen::VectorXd> next();

 private:
  struct Minimum {
    Eigen::VectorXd x;
    double deviation;
  };
  std::vector<Eigen::VectorXd> search() const;
  DesignProblem corrected_problem() const;
  std::optional<Minimum> minimum_of(const DesignProblem& problem) const;

  const DesignSpace& space_;
  const PolishRounds& rounds_;
  std::optional<std::vector<Eigen::VectorXd>> starts_;  ///< starts that are left; none until they are searched for
};

/// Designs from anywhere within the bounds, as the survey proposes them.
class SurveyedStarts {
 public:
  /// `rounds` must outlive the object.
  explicit SurveyedStarts(const PolishRounds& rounds) : rounds_(rounds) {}

  /// The next design, in normalized parameters. None if no lower confidence bound is below the best deviation, after
  /// too many designs without improvement, or if no simulation has reached every sample.
  std::optional<Eigen::VectorXd> next();
  /// Says whether the last design improved on all before.
  void count(bool improved) { unsuccessful_ = improved ? 0 : unsuccessful_ + 1; }

 private:
  const PolishRounds& rounds_;
  std::optional<Survey> survey_;  ///< none until it is needed
  int unsuccessful_ = 0;          ///< consecutive surveyed designs without improvement
};

}  // namespace supple::design
