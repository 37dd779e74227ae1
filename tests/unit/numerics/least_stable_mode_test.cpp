#include "supple/numerics/least_stable_mode.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
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
    const auto mode = least_stable_mode(chain(n, shift), n, cholesky, {});
    ASSERT_TRUE(mode);
    EXPECT_NEAR(mode->curvature, lowest - shift, 1e-3 * std::max(lowest, shift)) << shift;
    Eigen::VectorXd exact(n);
    for (int i = 0; i < n; ++i) exact[i] = std::sin(std::numbers::pi * (i + 1) / (n + 1));
    EXPECT_NEAR(mode->direction.norm(), 1, 1e-12);
    if (shift < 0.1) {
      EXPECT_GT(mode->direction.dot(exact.normalized()), 0.99) << shift;
    }
  }
}

TEST(LeastStableMode, IsNoneWhereNoShiftIsPositiveDefinite) {
  const int n = 100;
  ShiftedCholesky cholesky;
  ASSERT_TRUE(cholesky.factorize(chain(n, 0), 0)) << "the factors of another matrix, which must not be used";
  SparseMatrix broken = chain(n, 0);
  broken.coeffRef(3, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(least_stable_mode(broken, n, cholesky, {}));
}

TEST(LowestAlongMode, GoesAsFarAsTheEnergyFallsAndTheBetterWay) {
  const auto steep = [](double x) { return x * x * (x * x - 2) + 0.1 * x; };
  const auto amount = lowest_along_mode(0, 1e-3, 12, steep);
  ASSERT_TRUE(amount);
  EXPECT_EQ(*amount, -1.024) << "of the powers of two the one nearest to -1, where the other way is less deep";
}

TEST(LowestAlongMode, TakesThePositiveWayOfTwoThatAreSymmetric) {
  int evaluations = 0;
  const auto well = [&](double x) {
    ++evaluations;
    return x * x * (x * x - 2);
  };
  EXPECT_EQ(lowest_along_mode(0, 1e-3, 12, well), 1.024);
  EXPECT_EQ(evaluations, 2 * 12) << "each way up to 2.048, the first amount that does not lessen the energy";
}

TEST(LowestAlongMode, StaysWhereItMayGo) {
  const auto slope = [](double x) { return std::abs(x) > 0.01 ? std::numeric_limits<double>::infinity() : -x * x; };
  EXPECT_EQ(lowest_along_mode(0, 1e-3, 12, slope), 8e-3);
  EXPECT_EQ(lowest_along_mode(0, 1e-3, 2, slope), 4e-3);
  EXPECT_FALSE(lowest_along_mode(0, 1e-3, 12, [](double x) { return x * x; }));
  EXPECT_FALSE(lowest_along_mode(0, 0.1, 12, slope));
}

}  // namespace
}  // namespace supple::numerics
