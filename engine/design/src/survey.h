#pragma once

#include <Eigen/Core>
#include <vector>

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

}  // namespace supple::design
