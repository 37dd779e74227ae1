#pragma once

#include <Eigen/Core>
#include <limits>

namespace supple::embedded {

/// The least t in (0, limit] at which a tetrahedron loses its volume. Its edges from one corner are the columns of
/// `edges + t * change`, so that t is the first root of a cubic that is positive at 0. The result is a lower bound with
/// a relative error of 1e-12; it is infinite if there is no root, and 0 if the volume is not positive at t = 0. A
/// volume that shrinks to 1e-12 of that at t = 0 counts as lost, so that roots of even order are found.
double first_inversion(const Eigen::Matrix3d& edges, const Eigen::Matrix3d& change,
                       double limit = std::numeric_limits<double>::infinity());

}  // namespace supple::embedded
