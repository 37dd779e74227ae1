#include "supple/numerics/cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "supple/base/random.h"
#include "supple/numerics/system.h"
#include "test_functions.h"

namespace supple::numerics {
namespace {

SparseMatrix chain_hessian(int n) {
  EnergySum sum;
  sum.clear(n, 2);
  SpringChain().add(VectorState{Eigen::VectorXd::Zero(n)}, 2, sum);
  return sum.hessian.matrix(n);
}

TEST(MatrixScale, DoesNotDependOnTheFramesOfPartsOfTheUnknowns) {
  const int n = 40;
  RandomStream random("frames of pairs", 1);
  Eigen::MatrixXd dense(n, n);
  for (double& entry : dense.reshaped()) entry = random.normal();
  dense = (dense + dense.transpose()).eval();
  const double scale = matrix_scale(dense);
  EXPECT_NEAR(scale, std::sqrt(dense.rowwise().squaredNorm().mean()), 1e-12 * scale);
  Eigen::MatrixXd frames = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < n; i += 2) {
    const double angle = random.uniform(0, 6);
    frames.block<2, 2>(i, i) << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  }
  const Eigen::MatrixXd turned = frames.transpose() * dense * frames;
  EXPECT_GT(std::abs(turned.diagonal().cwiseAbs().mean() - dense.diagonal().cwiseAbs().mean()), 1e-3);
  auto bordered = std::make_shared<BorderedMatrix>();
  const SparseMatrix sparse = turned.sparseView(1, 1e-30);
  bordered->core = sparse.triangularView<Eigen::Lower>();
  for (const Hessian& same :
       {Hessian(turned), Hessian(sparse), Hessian(std::shared_ptr<const BorderedMatrix>(bordered))})
    EXPECT_NEAR(matrix_scale(same), scale, 1e-12 * scale);
  EXPECT_EQ(matrix_scale(Eigen::MatrixXd::Zero(3, 3)), 1);
}

class ShiftedCholeskyOfSize : public ::testing::TestWithParam<int> {};

TEST_P(ShiftedCholeskyOfSize, SolvesASparseMatrixLikeTheDenseOne) {
  const int n = GetParam();
  const SparseMatrix sparse = chain_hessian(n);
  Eigen::VectorXd b(n);
  for (int i = 0; i < n; ++i) b[i] = std::cos(3 * i);
  for (const double shift : {0.0, 0.7}) {
    ShiftedCholesky by_sparse;
    ShiftedCholesky by_dense;
    ASSERT_TRUE(by_sparse.factorize(sparse, shift));
    ASSERT_TRUE(by_dense.factorize(Eigen::MatrixXd(sparse), shift));
    const Eigen::VectorXd x = by_sparse.solve(b);
    EXPECT_LT((x - by_dense.solve(b)).norm(), 1e-12 * x.norm());
    EXPECT_LT((sparse * x + shift * x - b).norm(), 1e-12 * b.norm());
  }
}

INSTANTIATE_TEST_SUITE_P(BothSidesOfTheDenseLimit, ShiftedCholeskyOfSize, ::testing::Values(2, 63, 64, 500));

TEST(ShiftedCholesky, AnalysesAPatternOnceForAllItsValues) {
  SparseMatrix matrix = chain_hessian(200);
  ShiftedCholesky cholesky;
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(cholesky.factorize(matrix, 0.1 * i));
    matrix *= 1.5;
  }
  EXPECT_EQ(cholesky.analyses(), 1);
  ASSERT_TRUE(cholesky.factorize(chain_hessian(300), 0));
  EXPECT_EQ(cholesky.analyses(), 2);
}

TEST(ShiftedCholesky, SolvesWithWhatIsOfLowRankLikeTheDenseOne) {
  for (const int n : {10, 200}) {
    for (const Eigen::Index border : {0, 2}) {
      auto matrix = std::make_shared<BorderedMatrix>();
      matrix->core = chain_hessian(n).triangularView<Eigen::Lower>();
      matrix->border = 0.1 * Eigen::MatrixXd::Ones(n, border);
      matrix->corner = 30 * Eigen::MatrixXd::Identity(border, border);
      matrix->low_rank.resize(n + border, 2);
      for (Eigen::Index i = 0; i < n + border; ++i) matrix->low_rank.row(i) << 5 * std::cos(2.0 * i), 1e3;
      const Eigen::MatrixXd full = dense(*matrix);
      const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(n + border, -1, 2);
      for (const double shift : {0.0, 0.7}) {
        ShiftedCholesky cholesky;
        ASSERT_TRUE(cholesky.factorize(std::shared_ptr<const BorderedMatrix>(matrix), shift));
        const Eigen::VectorXd x = cholesky.solve(b);
        EXPECT_LT((full * x + shift * x - b).norm(), 1e-13 * full.norm() * x.norm()) << n << " " << border;
        // Nothing of it stays for the next matrix.
        ASSERT_TRUE(cholesky.factorize(chain_hessian(n), shift));
        const Eigen::VectorXd y = cholesky.solve(b.head(n));
        EXPECT_LT((chain_hessian(n) * y + shift * y - b.head(n)).norm(), 1e-10 * b.norm());
      }
      matrix->low_rank(0, 0) = std::numeric_limits<double>::quiet_NaN();
      EXPECT_FALSE(ShiftedCholesky().factorize(std::shared_ptr<const BorderedMatrix>(matrix), 0));
    }
  }
}

TEST(ShiftedCholesky, SaysWhereTheMatrixIsNotPositiveDefiniteAndTheShiftMendsIt) {
  for (const int n : {10, 200}) {
    SparseMatrix matrix = chain_hessian(n);
    matrix.coeffRef(n / 2, n / 2) = -3;
    ShiftedCholesky cholesky;
    EXPECT_FALSE(cholesky.factorize(matrix, 0)) << n;
    EXPECT_TRUE(cholesky.factorize(matrix, 20)) << n;
    EXPECT_FALSE(cholesky.factorize(matrix, 0)) << n << ": a success must not hide the next failure";
  }
}

TEST(ShiftedCholesky, RefusesAMatrixThatIsNotFinite) {
  for (const int n : {10, 200}) {
    SparseMatrix matrix = chain_hessian(n);
    matrix.coeffRef(0, 0) = std::numeric_limits<double>::quiet_NaN();
    ShiftedCholesky cholesky;
    EXPECT_FALSE(cholesky.factorize(matrix, 0)) << n;
  }
}

TEST(ShiftedCholesky, ReusesNothingWhenTheSizeStaysAndThePatternChanges) {
  ShiftedCholesky cholesky;
  SparseMatrix chain = chain_hessian(100);
  ASSERT_TRUE(cholesky.factorize(chain, 0));
  SparseMatrix ring = chain;
  ring.coeffRef(0, 99) = -0.5;
  ring.coeffRef(99, 0) = -0.5;
  ASSERT_TRUE(cholesky.factorize(ring, 0));
  const Eigen::VectorXd b = Eigen::VectorXd::Ones(100);
  EXPECT_LT((ring * cholesky.solve(b) - b).norm(), 1e-11);
}

}  // namespace
}  // namespace supple::numerics
