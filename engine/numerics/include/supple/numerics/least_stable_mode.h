#pragma once

#include <Eigen/Core>

#include "supple/base/cancellation.h"
#include "supple/numerics/cholesky.h"

namespace supple::numerics {

/// The direction in which an energy curves least, and its curvature per squared length of the direction.
struct Mode {
  Eigen::VectorXd direction;  ///< of unit length; its entry of largest magnitude is positive
  double curvature = 0;
};

/// The lowest eigenpair of a symmetric matrix of n unknowns, by Lanczos' method on the inverse of the matrix shifted
/// until it is positive definite. A curvature below zero is never overestimated by more than a few percent. Some
/// factorizations and about 30 solves; `cholesky` is left with the shifted matrix.
Mode least_stable_mode(const Hessian& hessian, Eigen::Index n, ShiftedCholesky& cholesky,
                       const CancellationToken& cancellation);

}  // namespace supple::numerics
