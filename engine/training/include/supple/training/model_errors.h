#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/neural/model.h"
#include "supple/training/samples.h"

namespace supple::training {

/// Least energy density (MPa) of the rows on which errors are measured [Thesis, section 4.4.1].
inline constexpr double min_evaluated_energy = 1e-5;

/// The relative errors of a network on those rows whose energy is at least `min_evaluated_energy`. Simulated values
/// have a star. The errors are |Phi - Phi*| / Phi* for the energy and |S - S*| / |S*| for the stress, with |S|^2 =
/// S_xx^2 + S_yy^2 + S_xy^2. For the tangent stiffness they are |v^T (C - C*) v| / |v^T C* v| with v = C*^-1 S*, the
/// strain increment along which the load of the row grows in proportion. In a uniaxial state this is, to first order,
/// the error of the stiffness along the load.
struct RowErrors {
  std::vector<int> rows;  ///< the rows that were evaluated; entry i of each vector belongs to rows[i]
  Eigen::VectorXd energy;
  Eigen::VectorXd gradient;  ///< errors of the stress
  Eigen::VectorXd stiffness;
};

/// Computes these errors in double precision, on thread_count() threads. Takes about 150 microseconds for each row at a
/// width of 256. The network is evaluated without its correction of the mesh, because the rows have the mesh's error.
RowErrors row_errors(const neural::Network& network, const Samples& samples, const std::vector<int>& rows);

/// The quantile of the errors at a fraction from 0 to 1, interpolated linearly. There must be at least one error.
double quantile(const Eigen::VectorXd& errors, double fraction);
neural::ErrorStatistics statistics(const Eigen::VectorXd& errors);
neural::SplitErrors split_errors(const neural::Network& network, const Samples& samples, const std::vector<int>& rows);

/// The range of strains and energies in these rows. Energies are relative to the network's stiffness of the undeformed
/// design; see neural::StrainRange.
neural::StrainRange strain_range(const neural::Network& network, const Samples& samples, const std::vector<int>& rows);

}  // namespace supple::training
