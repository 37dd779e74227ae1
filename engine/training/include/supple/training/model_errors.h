#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/neural/model.h"
#include "supple/training/samples.h"

namespace supple::training {

/// Only rows of at least this energy density (MPa) count for errors, as in the thesis's tables (4.4.1).
inline constexpr double least_judged_energy = 1e-5;

/// The relative errors of a network on those of the rows whose energy is at least `least_judged_energy`. They are |Phi
/// - Phi*| / Phi* for the energy and |S - S*| / |S*| for the stress, with |S|^2 = S_xx^2 + S_yy^2 + S_xy^2. For the
/// tangent stiffness under the row's own load they are |v^T (C - C*) v| / |v^T C* v| with v = C*^-1 S*. In a uniaxial
/// state this is the stiffness along its direction, to first order.
struct RowErrors {
  std::vector<int> rows;  ///< the rows that were judged
  Eigen::VectorXd energy;
  Eigen::VectorXd gradient;
  Eigen::VectorXd stiffness;
};

/// Computes these errors in double precision, on all counted threads. Takes about 150 microseconds a row at a width of
/// 256.
RowErrors row_errors(const neural::Network& network, const Samples& samples, const std::vector<int>& rows);

/// The number that a share (0 to 1) of the errors does not exceed. There must be at least one error.
double quantile(const Eigen::VectorXd& errors, double share);
neural::ErrorStatistics statistics(const Eigen::VectorXd& errors);
neural::SplitErrors split_errors(const neural::Network& network, const Samples& samples, const std::vector<int>& rows);

/// The range of strains in these rows, with the network's rest stiffness; see neural::StrainRange.
neural::StrainRange strain_range(const neural::Network& network, const Samples& samples, const std::vector<int>& rows);

}  // namespace supple::training
