#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "corrected_model.h"

namespace supple::design {

/// Interpolates the difference between simulations and the network: c(x) = w_0 + sum_i w_i |x - x_i| with sum w_i = 0.
/// The interpolant of different points x_i is unique [Micchelli1986]. Differences between close neighbours, such as
/// noise of the mesh, are smoothed.
class CorrectionField {
 public:
  /// `points` are normalized parameters, `corrections` their corrections with one entry for each sample. O(n^3) for n
  /// points.
  CorrectionField(std::vector<Eigen::VectorXd> points, const std::vector<Eigen::VectorXd>& corrections);

  /// The correction at x, and its derivatives (samples x parameters). There must be at least one point.
  Eigen::VectorXd at(const Eigen::VectorXd& x) const;
  Eigen::MatrixXd slope(const Eigen::VectorXd& x) const;

 private:
  std::vector<Eigen::VectorXd> points_;
  Eigen::MatrixXd weights_;  ///< one row for each point, and last that of w_0; one column for each sample
};

/// Chooses the next design to simulate from points all over the box. It is the point with the least lower confidence
/// bound of the simulated deviation [Cox1992]: the deviation of the network with the field of corrections, minus a
/// multiple of the error bars.
class Survey {
 public:
  /// The result of a simulation: normalized parameters, and the difference between simulation and network.
  struct Observation {
    Eigen::VectorXd x;
    Eigen::VectorXd correction;
  };

  /// Evaluates the network at 64 points for each free parameter, at most 256, in parallel. Moves the 128 points with
  /// the least bounds to a minimum of the corrected network nearby. The arguments are those of `next`, and `model` must
  /// outlive the survey.
  Survey(const CorrectedModel& model, const std::vector<Observation>& observations,
         const std::vector<Eigen::VectorXd>& tried, const CancellationToken& cancellation);

  /// The next design; none if every lower confidence bound is at least `below`. `observations` must not be empty.
  /// `tried` are all simulated designs, including those whose simulation failed.
  std::optional<Eigen::VectorXd> next(const std::vector<Observation>& observations,
                                      const std::vector<Eigen::VectorXd>& tried, double below);

 private:
  struct SurveyPoint {
    Eigen::VectorXd x;
    CorrectedModel::Values model;
  };

  CorrectionField field_of(const std::vector<Observation>& observations) const;
  double lower_confidence_bound(const SurveyPoint& place, const CorrectionField& field,
                                const std::vector<Eigen::VectorXd>& tried) const;
  void refine(const CorrectionField& field, const std::vector<Eigen::VectorXd>& tried, double radius,
              const CancellationToken& cancellation);

  const CorrectedModel& model_;
  std::vector<SurveyPoint> survey_points_;  ///< points that were not simulated yet
};

}  // namespace supple::design
