#include "supple/numerics/least_stable_mode.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "supple/base/random.h"

namespace supple::numerics {
namespace {

/// Shifts relative to the matrix's scale, in ascending order: a small one separates the eigenvalues of the inverse
/// best.
constexpr double first_shift = 1e-9;
constexpr double shift_growth = 4;
constexpr double max_shift = 1e3;

constexpr int lanczos_steps = 40;
/// The Ritz value has converged once a step changes it by at most this, relative to its magnitude.
constexpr double ritz_tolerance = 1e-6;

/// Decreases of the energy in the two directions that differ by less than this, relative, count as equal.
constexpr double symmetry_tolerance = 1e-9;

/// The first shift that makes the matrix positive definite, whose factors `cholesky` then holds; none up to max_shift.
std::optional<double> shift_until_definite(const Hessian& hessian, ShiftedCholesky& cholesky,
                                           const CancellationToken& cancellation) {
  const double scale = matrix_scale(hessian);
  double shift = first_shift * scale;
  while (!cholesky.factorize(hessian, shift)) {
    cancellation.throw_if_requested();
    if (!(shift < max_shift * scale)) return std::nullopt;
    shift *= shift_growth;
  }
  return shift;
}

}  // namespace

std::optional<Mode> least_stable_mode(const Hessian& hessian, Eigen::Index n, ShiftedCholesky& cholesky,
                                      const CancellationToken& cancellation) {
  cholesky.stop_with(cancellation);
  const std::optional<double> shift = shift_until_definite(hessian, cholesky, cancellation);
  if (!shift) return std::nullopt;
  const int steps = static_cast<int>(std::min<Eigen::Index>(lanczos_steps, n));
  Eigen::MatrixXd basis(n, steps + 1);
  Eigen::VectorXd diagonal(steps);
  Eigen::VectorXd off_diagonal(steps);
  RandomStream random("least_stable_mode", 0);
  for (Eigen::Index i = 0; i < n; ++i) basis(i, 0) = random.uniform(-1, 1);
  basis.col(0).normalize();

  double last = 0;
  int size = 0;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz;
  while (size < steps) {
    cancellation.throw_if_requested();
    Eigen::VectorXd next = cholesky.solve(basis.col(size));
    diagonal[size] = basis.col(size).dot(next);
    // Orthogonalizes twice: once is not enough if the first mode dominates.
    const auto used = basis.leftCols(size + 1);
    for (int pass = 0; pass < 2; ++pass) next -= used * (used.transpose() * next);
    off_diagonal[size] = next.norm();
    ++size;
    ritz.computeFromTridiagonal(diagonal.head(size), off_diagonal.head(std::max(0, size - 1)));
    const double largest = ritz.eigenvalues()[size - 1];
    if (std::abs(largest - last) <= ritz_tolerance * std::abs(largest) || off_diagonal[size - 1] <= 1e-14 * largest)
      break;
    last = largest;
    basis.col(size) = next / off_diagonal[size - 1];
  }
  Mode mode;
  mode.direction = (basis.leftCols(size) * ritz.eigenvectors().col(size - 1)).normalized();
  Eigen::Index peak = 0;
  mode.direction.cwiseAbs().maxCoeff(&peak);
  if (mode.direction[peak] < 0) mode.direction = -mode.direction;
  mode.curvature = 1 / ritz.eigenvalues()[size - 1] - *shift;
  return mode;
}

std::optional<double> lowest_along_mode(double energy, double first, int doublings,
                                        const std::function<double(double amount)>& energy_at) {
  double lowest = energy;
  std::optional<double> best;
  for (const double sign : {1.0, -1.0}) {
    double last = energy;
    for (int doubled = 0; doubled <= doublings; ++doubled) {
      const double amount = sign * std::ldexp(first, doubled);
      const double value = energy_at(amount);
      if (!(value < last)) break;
      last = value;
      if (value < lowest - symmetry_tolerance * std::abs(energy - lowest)) {
        lowest = value;
        best = amount;
      }
    }
  }
  return best;
}

}  // namespace supple::numerics
