#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "supple/base/cancellation.h"
#include "supple/numerics/cholesky.h"

namespace supple::numerics {

/// The direction in which an energy has the least curvature, and that curvature (per squared length).
struct Mode {
  Eigen::VectorXd direction;  ///< unit vector; its entry of largest magnitude is positive
  double curvature = 0;
};

/// The lowest eigenpair of a symmetric matrix of n unknowns, by the Lanczos method on the inverse of the matrix, which
/// is shifted until it is positive definite. A negative curvature is overestimated by a few percent at most. Takes some
/// factorizations and about 30 solves. `cholesky` then holds the factors of the shifted matrix. None if no shift makes
/// the matrix positive definite, because its entries are not finite or their sizes differ by more than rounding allows.
std::optional<Mode> least_stable_mode(const Hessian& hessian, Eigen::Index n, ShiftedCholesky& cholesky,
                                      const CancellationToken& cancellation);

/// The step length along an unstable mode that has the lowest energy. Tried are first, 2 first, 4 first, ...
/// (`doublings` doublings) and their negatives. Each direction ends where the energy no longer falls. If both
/// directions are symmetric, the positive one is taken. `energy` is the energy at 0. `energy_at` is infinite for
/// invalid states. Empty if no length lowers the energy. At most 2 (doublings + 1) evaluations.
std::optional<double> lowest_along_mode(double energy, double first, int doublings,
                                        const std::function<double(double amount)>& energy_at);

}  // namespace supple::numerics
