#pragma once

#include <Eigen/Core>
#include <limits>

namespace supple::embedded {

/// The least t in (0, limit] at which a tetrahedron whose edges from one corner are the columns of `edges + t * change`
/// loses its volume: the first root of a cubic whose value at 0 is positive, from below to 12 digits. Infinity where
/// there is none; 0 where the tetrahedron has no volume to lose. A volume that comes down to 1e-12 of what it was
/// counts as lost, so that roots of even order are found.
double first_inversion(const Eigen::Matrix3d& edges, const Eigen::Matrix3d& change,
                       double limit = std::numeric_limits<double>::infinity());

}  // namespace supple::embedded
