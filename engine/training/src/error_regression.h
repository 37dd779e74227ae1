#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/neural/calibration.h"

namespace supple::training {

/// Errors of one quantity at states, a row of `features` for each.
struct ObservedErrors {
  Eigen::MatrixXd features;
  Eigen::VectorXd error;    ///< as in neural::Quantity
  std::vector<int> fold;    ///< of the design, from 0; -1 where the network was trained on it
  std::vector<int> design;  ///< any number that is the design's own
};

/// log(error + floor) as a quadratic polynomial of features, fitted with any folds left out: what is summed over the
/// states of a fold is kept, so that a fit is one solution of a linear system. For n features that has m = n^2/2 + 5n/2
/// + 2 unknowns: O(m^2) for each state, O(m^3) for each fit.
class ErrorRegression {
 public:
  /// `scale` receives limits, means and deviations of the features.
  ErrorRegression(const ObservedErrors& observed, int folds, double floor, neural::ErrorScale& scale);

  /// Coefficients of neural::quadratic_terms, of states that the network was not trained on; folds a and b are left
  /// out (negative: none).
  Eigen::VectorXd fit(int a, int b) const;
  /// Values of the polynomial at the states of a fold, in their order.
  Eigen::VectorXd rate(const Eigen::VectorXd& coefficients, int fold) const;
  /// log(error + floor) there.
  const Eigen::VectorXd& logarithms(int fold) const { return held_[static_cast<std::size_t>(fold)].target; }
  int folds() const { return static_cast<int>(held_.size()); }

 private:
  struct Group {
    Eigen::MatrixXd terms;  ///< of held-out states, a column for each
    Eigen::VectorXd target;
    Eigen::MatrixXd gram;
    Eigen::VectorXd right;
    double weight = 0;
  };
  static void add(Group& group, const Eigen::MatrixXd& columns, const Eigen::VectorXd& target, double weight);

  Eigen::Index quadratic_ = 0;  ///< number of terms
  Eigen::Index all_ = 0;        ///< with those of designs that were trained on
  Group trained_;
  std::vector<Group> held_;
};

/// Knots and offsets such that of states like these a share of `level` has log error <= rating + offset: quantiles in
/// `groups` groups of equal size by rating.
neural::BarOffsets conformal_offsets(const Eigen::VectorXd& ratings, const Eigen::VectorXd& logarithms, double level,
                                     int groups);

}  // namespace supple::training
