#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

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

/// How far to go along an unstable mode: of the amounts first, 2 first, 4 first, ..., `doublings` doublings in all, and
/// their negatives, the one of lowest energy. Each way ends where the energy no longer falls; the positive one is taken
/// where the two are symmetric. `energy` is that at 0, `energy_at` is infinite beyond what is allowed. Nothing where no
/// amount lowers the energy. At most 2 (doublings + 1) evaluations.
std::optional<double> lowest_along_mode(double energy, double first, int doublings,
                                        const std::function<double(double amount)>& energy_at);

}  // namespace supple::numerics
