#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/neural/model.h"
#include "supple/training/samples.h"

namespace supple::training {

/// Rows of at least this energy density count for errors, as in the thesis's tables (4.4.1); MPa.
inline constexpr double least_judged_energy = 1e-5;

/// Relative errors of a network's energy and stress: |Phi - Phi*| / Phi* and |S - S*| / |S*| with |S|^2 = S_xx^2 +
/// S_yy^2 + S_xy^2, of those of the rows whose energy is at least `least_judged_energy`; and of its tangent stiffness
/// against more of the row's own load, |v^T (C - C*) v| / |v^T C* v| with v = C*^-1 S*. Of a uniaxial state that is the
/// stiffness along its direction, to first order.
struct RowErrors {
  std::vector<int> rows;  ///< that were judged
  Eigen::VectorXd energy;
  Eigen::VectorXd gradient;
  Eigen::VectorXd stiffness;
};

/// In double precision, on all counted threads; about 150 microseconds a row at a width of 256.
RowErrors row_errors(const neural::Network& network, const Samples& samples, const std::vector<int>& rows);

/// What a share (0 to 1) of the errors, of which there is at least one, do not exceed.
double quantile(const Eigen::VectorXd& errors, double share);
neural::ErrorStatistics statistics(const Eigen::VectorXd& errors);
neural::SplitErrors split_errors(const neural::Network& network, const Samples& samples, const std::vector<int>& rows);

/// Of these rows and the network's rest stiffness; see neural::StrainRange.
neural::StrainRange strain_range(const neural::Network& network, const Samples& samples, const std::vector<int>& rows);

}  // namespace supple::training
