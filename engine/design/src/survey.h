#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "corrected_model.h"

namespace supple::design {

/// By how much simulations differ from the network, between the structures that were simulated: the interpolant
/// c(x) = w_0 + sum_i w_i |x - x_i| of their corrections with sum w_i = 0, of which there is one for any different
/// points (Micchelli 1986). Corrections that neighbours do not share, such as the noise of meshes, are smoothed.
class CorrectionField {
 public:
  /// Points as shares of the bounds' widths, and their corrections, an entry for each sample. O(n^3) for n points.
  CorrectionField(std::vector<Eigen::VectorXd> points, const std::vector<Eigen::VectorXd>& corrections);

  /// The correction at x, and its slope (samples x parameters). There has to be a point.
  Eigen::VectorXd at(const Eigen::VectorXd& x) const;
  Eigen::MatrixXd slope(const Eigen::VectorXd& x) const;

 private:
  std::vector<Eigen::VectorXd> points_;
  Eigen::MatrixXd weights_;  ///< a row for each point, the last one of the constant; a column for each sample
};

/// Places all over the box, of which those are simulated next whose simulation may come nearest to the target: the
/// deviation of the network with the field of corrections, less what the error bars leave open there, is least (a lower
/// confidence bound, Cox and John 1992).
class Survey {
 public:
  /// What a simulation has said: where, and how it differed from the network.
  struct Known {
    Eigen::VectorXd x;
    Eigen::VectorXd correction;
  };

  /// Evaluates the network at 64 places for each free parameter, at most 256, in parallel, and moves the most promising
  /// to where the corrected network deviates least nearby. `known` as for `next`; `model` outlives the survey.
  Survey(const CorrectedModel& model, const std::vector<Known>& known, const std::vector<Eigen::VectorXd>& tried,
         const CancellationToken& cancellation);

  /// The next place; nothing where none may deviate by less than `below`. `known` are at least one simulation, `tried`
  /// all designs that were simulated, also those whose simulation failed.
  std::optional<Eigen::VectorXd> next(const std::vector<Known>& known, const std::vector<Eigen::VectorXd>& tried,
                                      double below);

 private:
  struct Place {
    Eigen::VectorXd x;
    CorrectedModel::Values model;
  };

  CorrectionField field_of(const std::vector<Known>& known) const;
  double least_to_expect(const Place& place, const CorrectionField& field,
                         const std::vector<Eigen::VectorXd>& tried) const;
  void settle(const CorrectionField& field, const std::vector<Eigen::VectorXd>& tried, double radius,
              const CancellationToken& cancellation);

  const CorrectedModel& model_;
  std::vector<Place> places_;  ///< that were not simulated yet
};

}  // namespace supple::design
