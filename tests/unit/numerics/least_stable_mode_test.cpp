#include "supple/numerics/least_stable_mode.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

namespace supple::numerics {
namespace {

/// A chain of n masses on springs between walls, its stiffness lowered by `shift`: eigenvalues 4 sin^2(k pi / (2 (n +
/// 1))) - shift.
SparseMatrix chain(int n, double shift) {
  SparseMatrix matrix(n, n);
  for (int i = 0; i < n; ++i) {
    matrix.coeffRef(i, i) = 2 - shift;
    if (i > 0) matrix.coeffRef(i, i - 1) = matrix.coeffRef(i - 1, i) = -1;
  }
  matrix.makeCompressed();
  return matrix;
}

TEST(LeastStableMode, IsTheLowestEigenpairOfAnIndefiniteAndOfADefiniteMatrix) {
  const int n = 100;
  const double lowest = 4 * std::pow(std::sin(std::numbers::pi / (2 * (n + 1))), 2);
  for (const double shift : {0.0, 5e-3, 0.2}) {
    ShiftedCholesky cholesky;
    const Mode mode = least_stable_mode(chain(n, shift), n, cholesky, {});
    EXPECT_NEAR(mode.curvature, lowest - shift, 1e-3 * std::max(lowest, shift)) << shift;
    Eigen::VectorXd exact(n);
    for (int i = 0; i < n; ++i) exact[i] = std::sin(std::numbers::pi * (i + 1) / (n + 1));
    EXPECT_NEAR(mode.direction.norm(), 1, 1e-12);
    if (shift < 0.1) {
      EXPECT_GT(mode.direction.dot(exact.normalized()), 0.99) << shift;
    }
  }
}

}  // namespace
}  // namespace supple::numerics
