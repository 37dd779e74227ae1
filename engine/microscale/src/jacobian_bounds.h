#pragma once

#include <Eigen/Core>

namespace supple::microscale {

/// The least det F over a quadratic triangle with straight sides at rest. F is linear over it, so det F is a quadratic
/// polynomial: its minimum lies at a corner, on a side or where its gradient vanishes.
///
/// `gradients` are those of the three barycentric coordinates, 1/mm. `displacements` are the periodic parts of those of
/// the six nodes, mm. `strain_change` is the cell's macroscopic F - I.
double smallest_quadratic_jacobian(const Eigen::Matrix<double, 2, 3>& gradients,
                                   const Eigen::Matrix<double, 2, 6>& displacements,
                                   const Eigen::Matrix2d& strain_change);

}  // namespace supple::microscale
