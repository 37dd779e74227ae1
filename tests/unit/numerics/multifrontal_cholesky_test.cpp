#include "multifrontal_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <vector>

#include "partial_cholesky.h"
#include "supple/base/random.h"
#include "supple/base/threads.h"
#include "supple/numerics/cholesky.h"
#include "support/expect_error.h"

namespace supple::numerics {
namespace {

/// A random diagonally dominant matrix with about `degree` entries in a row.
SparseMatrix random_matrix(int n, int degree, std::uint64_t seed) {
  RandomStream random("multifrontal", seed);
  Eigen::VectorXd diagonal = Eigen::VectorXd::Constant(n, 0.1);
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < n * degree / 2; ++k) {
    const int i = random.below(n);
    const int j = random.below(n);
    if (i == j) continue;
    const double value = random.uniform(-1, 1);
    entries.emplace_back(i, j, value);
    entries.emplace_back(j, i, value);
    diagonal[i] += std::abs(value);
    diagonal[j] += std::abs(value);
  }
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, diagonal[i]);
  SparseMatrix matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Eigen::MatrixXd random_columns(int n, int columns) {
  RandomStream random("right-hand sides", 0);
  return Eigen::MatrixXd::NullaryExpr(n, columns, [&random] { return random.uniform(-1, 1); });
}

TEST(PartialCholesky, LeavesFactorsAndTheSchurComplementForEveryShapeOfFront) {
  RandomStream random("fronts", 0);
  for (int rows = 1; rows <= 30; ++rows) {
    for (int pivots = 1; pivots <= rows; ++pivots) {
      const int ld = rows + random.below(4);
      const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(rows, rows, [&random] { return random.uniform(-1, 1); });
      const Eigen::MatrixXd spd = a * a.transpose() + Eigen::MatrixXd::Identity(rows, rows);
      Eigen::MatrixXd front = Eigen::MatrixXd::Zero(ld, rows);
      front.topRows(rows) = spd;
      ASSERT_TRUE(partial_cholesky(front.data(), ld, rows, pivots));
      const Eigen::MatrixXd panel = front.topLeftCorner(rows, pivots).triangularView<Eigen::Lower>();
      Eigen::MatrixXd left = spd - panel * panel.transpose();
      left.bottomRightCorner(rows - pivots, rows - pivots) -= front.block(pivots, pivots, rows - pivots, rows - pivots);
      EXPECT_LT(Eigen::MatrixXd(left.triangularView<Eigen::Lower>()).cwiseAbs().maxCoeff(), 1e-11)
          << rows << " rows, " << pivots << " pivots";
    }
  }
}

// Large fronts go another way; their last panels, tiles and columns are seldom full.
TEST(PartialCholesky, LeavesTheSameOfLargeFronts) {
  RandomStream random("fronts", 1);
  for (const int rows : {319, 320, 321, 327, 557}) {
    const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(rows, rows, [&random] { return random.uniform(-1, 1); });
    const Eigen::MatrixXd spd = a * a.transpose() + rows * Eigen::MatrixXd::Identity(rows, rows);
    for (const int pivots : {1, 4, 47, 48, 49, 97, rows - 5, rows - 1, rows}) {
      const int ld = rows + random.below(4);
      Eigen::VectorXd front = Eigen::VectorXd::Constant(ld * rows + 16, 0.25);
      Eigen::Map<Eigen::MatrixXd> inside(front.data(), ld, rows);
      inside.topRows(rows) = spd;
      ASSERT_TRUE(partial_cholesky(front.data(), ld, rows, pivots));
      const Eigen::MatrixXd panel = inside.topLeftCorner(rows, pivots).triangularView<Eigen::Lower>();
      Eigen::MatrixXd left = spd - panel * panel.transpose();
      left.bottomRightCorner(rows - pivots, rows - pivots) -=
          inside.block(pivots, pivots, rows - pivots, rows - pivots);
      EXPECT_LT(Eigen::MatrixXd(left.triangularView<Eigen::Lower>()).cwiseAbs().maxCoeff(), 1e-10)
          << rows << " rows, " << pivots << " pivots";
      EXPECT_EQ(front.tail(16), Eigen::VectorXd::Constant(16, 0.25)) << rows << " rows, " << pivots << " pivots";
    }
  }
}

// Threads share what a panel takes from the columns behind it. Fronts that are factorized side by side do so, too, and
// each keeps its own copy of a panel meanwhile.
TEST(PartialCholesky, LeavesTheSameBitsOfLargeFrontsForAnyNumberOfThreads) {
  constexpr int fronts = 6;
  constexpr int rows = 700;
  constexpr int pivots = 200;
  RandomStream random("fronts", 2);
  std::vector<Eigen::MatrixXd> given;
  for (int i = 0; i < fronts; ++i) {
    const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(rows, 60, [&random] { return random.uniform(-1, 1); });
    given.emplace_back(a * a.transpose() + rows * Eigen::MatrixXd::Identity(rows, rows));
  }
  const auto factors = [&](int threads, bool side_by_side) {
    set_thread_count(threads);
    std::vector<Eigen::MatrixXd> result = given;
    const auto factorize = [&](int i) {
      ASSERT_TRUE(partial_cholesky(result[static_cast<std::size_t>(i)].data(), rows, rows, pivots));
    };
    if (side_by_side) {
      parallel_for(fronts, factorize);
    } else {
      for (int i = 0; i < fronts; ++i) factorize(i);
    }
    set_thread_count(0);
    return result;
  };
  const auto expected = factors(1, false);
  for (const int threads : {2, 4}) {
    for (const bool side_by_side : {false, true}) {
      const auto found = factors(threads, side_by_side);
      for (std::size_t i = 0; i < fronts; ++i)
        EXPECT_TRUE(Eigen::MatrixXd(found[i].triangularView<Eigen::Lower>()) ==
                    Eigen::MatrixXd(expected[i].triangularView<Eigen::Lower>()))
            << threads << " threads, front " << i;
    }
  }
}

TEST(PartialCholesky, EndsWhenItIsStopped) {
  constexpr int rows = 600;
  CancellationToken token;
  token.request(StopReason::cancelled);
  const Eigen::MatrixXd given = Eigen::MatrixXd::Identity(rows, rows) + Eigen::MatrixXd::Constant(rows, rows, 1);
  Eigen::MatrixXd front = given;
  EXPECT_FALSE(partial_cholesky(front.data(), rows, rows, rows, token));
  EXPECT_EQ(front, given);
}

TEST(PartialCholesky, RefusesAFrontThatIsNotPositiveDefiniteInItsPivots) {
  Eigen::MatrixXd front = Eigen::MatrixXd::Identity(12, 12);
  front(5, 5) = -1;
  EXPECT_TRUE(partial_cholesky(Eigen::MatrixXd(front).data(), 12, 12, 5));
  EXPECT_FALSE(partial_cholesky(Eigen::MatrixXd(front).data(), 12, 12, 6));
  front(5, 5) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(partial_cholesky(front.data(), 12, 12, 8));
}

class MultifrontalCholeskyOf : public ::testing::TestWithParam<std::tuple<int, int>> {};

TEST_P(MultifrontalCholeskyOf, SolvesWithEveryNumberOfRightHandSides) {
  const auto [n, degree] = GetParam();
  const SparseMatrix matrix = random_matrix(n, degree, 1);
  MultifrontalCholesky cholesky;
  cholesky.analyze(matrix);
  for (const double shift : {0.0, 0.3}) {
    ASSERT_TRUE(cholesky.factorize(matrix, shift));
    for (int columns = 1; columns <= 6; ++columns) {
      const Eigen::MatrixXd b = random_columns(n, columns);
      Eigen::MatrixXd x = b;
      cholesky.solve(x);
      EXPECT_LT((matrix * x + shift * x - b).norm(), 1e-12 * b.norm()) << columns << " columns";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(SizesAndDensities, MultifrontalCholeskyOf,
                         ::testing::Combine(::testing::Values(1, 7, 64, 500), ::testing::Values(0, 2, 6)));

/// Of a cube of n x n x n places, each joined with its 26 neighbours: enough work for several subtrees and large
/// fronts.
SparseMatrix cube_matrix(int n) {
  RandomStream random("cube", 0);
  const auto number = [n](int i, int j, int k) { return (i * n + j) * n + k; };
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n * n * n; ++i) entries.emplace_back(i, i, 27);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k)
        for (int x = i; x < std::min(n, i + 2); ++x)
          for (int y = std::max(0, j - 1); y < std::min(n, j + 2); ++y)
            for (int z = std::max(0, k - 1); z < std::min(n, k + 2); ++z)
              if (number(x, y, z) > number(i, j, k))
                entries.emplace_back(number(x, y, z), number(i, j, k), random.uniform(-1, 0));
  SparseMatrix matrix(n * n * n, n * n * n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

TEST(MultifrontalCholesky, SolvesWithTheSameBitsForAnyNumberOfThreads) {
  const SparseMatrix matrix = cube_matrix(15);
  const Eigen::MatrixXd b = random_columns(static_cast<int>(matrix.rows()), 1);
  const auto solution = [&](int threads) {
    set_thread_count(threads);
    MultifrontalCholesky cholesky;
    cholesky.analyze(matrix);
    Eigen::MatrixXd x = b;
    // The second time rooms and updates are those of the first.
    for (const double shift : {2.0, 0.5}) {
      x = b;
      EXPECT_TRUE(cholesky.factorize(matrix, shift));
      cholesky.solve(x);
    }
    set_thread_count(0);
    return x;
  };
  const Eigen::MatrixXd expected = solution(1);
  const Eigen::MatrixXd product = matrix.selfadjointView<Eigen::Lower>() * expected + 0.5 * expected;
  EXPECT_LT((product - b).norm(), 1e-12 * b.norm());
  for (const int threads : {2, 4}) EXPECT_EQ(solution(threads), expected) << threads;
}

TEST(MultifrontalCholesky, TakesMatricesOfOtherSizesOneAfterTheOther) {
  MultifrontalCholesky cholesky;
  for (const int n : {15, 12, 4, 16}) {
    const SparseMatrix matrix = cube_matrix(n);
    const Eigen::MatrixXd b = random_columns(static_cast<int>(matrix.rows()), 1);
    Eigen::MatrixXd x = b;
    cholesky.analyze(matrix);
    ASSERT_TRUE(cholesky.factorize(matrix, 0)) << n;
    cholesky.solve(x);
    const Eigen::MatrixXd product = matrix.selfadjointView<Eigen::Lower>() * x;
    EXPECT_LT((product - b).norm(), 1e-12 * b.norm()) << n;
  }
}

TEST(MultifrontalCholesky, SaysWhereAPartOfALargeMatrixIsNotPositiveDefiniteOrHasToStop) {
  const SparseMatrix matrix = cube_matrix(15);
  MultifrontalCholesky cholesky;
  cholesky.analyze(matrix);
  EXPECT_TRUE(cholesky.factorize(matrix, 0));
  for (const int k : {0, 1700, 3374}) {
    SparseMatrix spoilt = matrix;
    spoilt.coeffRef(k, k) = -1;
    EXPECT_FALSE(cholesky.factorize(spoilt, 0)) << k;
    EXPECT_TRUE(cholesky.factorize(matrix, 0)) << "after " << k;
  }
  CancellationToken token;
  cholesky.stop_with(token);
  token.request(StopReason::cancelled);
  supple::testing::expect_cancelled(StopReason::cancelled, [&] { cholesky.factorize(matrix, 0); });
}

TEST(MultifrontalCholesky, ReadsTheLowerTriangleOnly) {
  const SparseMatrix matrix = random_matrix(80, 5, 2);
  const SparseMatrix lower = matrix.triangularView<Eigen::Lower>();
  MultifrontalCholesky of_both;
  MultifrontalCholesky of_lower;
  of_both.analyze(matrix);
  of_lower.analyze(lower);
  ASSERT_TRUE(of_both.factorize(matrix, 0));
  ASSERT_TRUE(of_lower.factorize(lower, 0));
  Eigen::MatrixXd x = random_columns(80, 1);
  Eigen::MatrixXd y = x;
  of_both.solve(x);
  of_lower.solve(y);
  EXPECT_LT((x - y).norm(), 1e-13 * x.norm());
}

// Places come and go one by one, as where paths lead over other faces: fronts grow, shrink and get other parents.
TEST(MultifrontalCholesky, FollowsAPatternThatChangesALittleManyTimes) {
  constexpr int n = 1200;
  RandomStream random("multifrontal", 5);
  MultifrontalCholesky cholesky;
  std::vector<Eigen::Triplet<double>> added;
  const auto around = [](int i) { return (i + n) % n; };
  for (int round = 0; round < 60; ++round) {
    for (int k = 0; k < 8; ++k) {
      // Most near each other, some far apart.
      const int i = random.below(n);
      const int j = random.below(8) == 0 ? random.below(n) : around(i + 1 + random.below(6));
      if (i == j) continue;
      added.emplace_back(i, j, random.uniform(-1, 1));
      added.emplace_back(j, i, added.back().value());
    }
    if (added.size() > 200) added.erase(added.begin(), added.begin() + 100);
    std::vector<Eigen::Triplet<double>> entries(added);
    for (int i = 0; i < n; ++i) {
      entries.emplace_back(i, i, 40);
      for (const int away : {-2, -1, 1, 2}) entries.emplace_back(i, around(i + away), -1);
    }
    SparseMatrix matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    cholesky.analyze(matrix);
    ASSERT_TRUE(cholesky.factorize(matrix, 0.5)) << "round " << round;
    for (const int columns : {1, 3}) {
      const Eigen::MatrixXd b = random_columns(n, columns);
      Eigen::MatrixXd x = b;
      cholesky.solve(x);
      ASSERT_LT((matrix * x + 0.5 * x - b).norm(), 1e-13 * b.norm()) << "round " << round;
    }
  }
}

TEST(MultifrontalCholesky, AgreesWithTheSignOfTheLowestEigenvalue) {
  const SparseMatrix matrix = random_matrix(60, 4, 3);
  const double lowest = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(Eigen::MatrixXd(matrix)).eigenvalues()[0];
  MultifrontalCholesky cholesky;
  cholesky.analyze(matrix);
  EXPECT_TRUE(cholesky.factorize(matrix, -lowest * (1 - 1e-9)));
  EXPECT_FALSE(cholesky.factorize(matrix, -lowest * (1 + 1e-9)));
}

TEST(ShiftedCholesky, SolvesABorderedMatrixLikeTheDenseOne) {
  for (const int n : {20, 200}) {
    const SparseMatrix whole = random_matrix(n + 3, 5, 4);
    auto bordered = std::make_shared<BorderedMatrix>();
    const Eigen::MatrixXd dense(whole);
    bordered->core = SparseMatrix(whole.topLeftCorner(n, n)).triangularView<Eigen::Lower>();
    bordered->border = dense.topRightCorner(n, 3);
    bordered->corner = dense.bottomRightCorner(3, 3);
    const Hessian hessian = std::shared_ptr<const BorderedMatrix>(bordered);
    ShiftedCholesky cholesky;
    ASSERT_TRUE(cholesky.factorize(hessian, 0.2));
    const Eigen::VectorXd b = random_columns(n + 3, 1);
    const Eigen::VectorXd x = cholesky.solve(b);
    EXPECT_LT((dense * x + 0.2 * x - b).norm(), 1e-12 * b.norm());
    // Positive definite in its core, not as a whole.
    bordered->corner(1, 1) = -10;
    EXPECT_FALSE(cholesky.factorize(hessian, 0.2));
  }
}

}  // namespace
}  // namespace supple::numerics
