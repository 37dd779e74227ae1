#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/neural/calibration.h"

namespace supple::training {

/// Errors of one quantity at simulated states.
struct ObservedErrors {
  Eigen::MatrixXd features;  ///< a row for each state
  Eigen::VectorXd error;     ///< as in neural::Quantity
  std::vector<int> fold;     ///< fold of the state's design, from 0; -1 if the network was trained on the design
  std::vector<int> design;   ///< a number that identifies the state's design
};

/// Regression of log(error + floor) by a quadratic polynomial of features, with any one or two folds left out. The
/// normal equations of each fold are stored, so that a fit solves one linear system. With n features it has m = n^2/2 +
/// 5n/2 + 2 unknowns. The constructor costs O(m^2) for each state, and a fit O(m^3).
class ErrorRegression {
 public:
  /// `scale` receives limits, means and standard deviations of the features.
  ErrorRegression(const ObservedErrors& observed, int folds, double floor, neural::ErrorScale& scale);

  /// Fits the polynomial without two folds (negative: without none) and returns the coefficients of
  /// neural::quadratic_terms. States on which the network was trained have additional terms, whose coefficients are not
  /// returned.
  Eigen::VectorXd fit(int first_fold, int second_fold) const;
  /// Values of the polynomial at the states of a fold, in their order.
  Eigen::VectorXd rate(const Eigen::VectorXd& coefficients, int fold) const;
  /// log(error + floor) of the same states.
  const Eigen::VectorXd& log_errors(int fold) const { return held_out_[static_cast<std::size_t>(fold)].target; }
  int folds() const { return static_cast<int>(held_out_.size()); }

 private:
  /// The normal equations of the states of a fold, or of those on which the network was trained.
  struct Group {
    Eigen::MatrixXd terms;   ///< quadratic terms, a column for each state; only of folds
    Eigen::VectorXd target;  ///< log(error + floor) of each state; only of folds
    Eigen::MatrixXd gram;    ///< Gram matrix of all terms, its lower triangle
    Eigen::VectorXd right_hand_side;
    double weight = 0;  ///< sum of the weights of the states
  };
  static void add(Group& group, const Eigen::MatrixXd& columns, const Eigen::VectorXd& target, double weight);

  Eigen::Index quadratic_terms_ = 0;  ///< number of neural::quadratic_terms
  Eigen::Index all_terms_ = 0;        ///< the same, and the additional terms of designs that were trained on
  Group trained_;
  std::vector<Group> held_out_;  ///< one for each fold
};

/// Offsets of error bars by split conformal prediction [Vovk2005]. States are sorted by rating and divided into
/// `groups` groups of equal size. The offset of a group is the quantile of log error minus rating at the fraction
/// `level`, and its knot is the median rating.
neural::BarOffsets conformal_offsets(const Eigen::VectorXd& ratings, const Eigen::VectorXd& log_errors, double level,
                                     int groups);

}  // namespace supple::training
