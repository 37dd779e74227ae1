#include "symbolic_analysis.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "partial_cholesky.h"
#include "supple/base/error.h"
#include "supple/base/helper_processes.h"
#include "supple/numerics/cholesky.h"
#include "supple/numerics/hessian_entries.h"
#include "support/expect_error.h"

namespace supple::numerics {
namespace {

/// The Laplacian of a grid plus one: its factor has large fronts.
SparseMatrix grid_matrix(int side) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto at = [side](int i, int j) { return i * side + j; };
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      entries.emplace_back(at(i, j), at(i, j), 5);
      for (const auto& [k, l] : {std::pair(i + 1, j), std::pair(i, j + 1)}) {
        if (k >= side || l >= side) continue;
        entries.emplace_back(at(i, j), at(k, l), -1);
        entries.emplace_back(at(k, l), at(i, j), -1);
      }
    }
  SparseMatrix matrix(side * side, side * side);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

TEST(SymbolicAnalysis, OfALargePatternIsTheSameInAHelperProcess) {
  const SparseMatrix matrix = grid_matrix(350);
  ASSERT_GE(matrix.nonZeros(), 500'000) << "large enough for a helper";
  const int n = static_cast<int>(matrix.rows());
  const SymbolicAnalysis here = analyse_here(n, matrix.outerIndexPtr(), matrix.innerIndexPtr(), {});
  use_helper_processes(std::make_shared<HelperProcesses>(HelperOptions{SUPPLE_HELPER, 1, 0}));
  const SymbolicAnalysis there = analyse(matrix, {}, {});
  const SymbolicAnalysis quick = analyse(matrix, {}, {}, OrderingSearch::quick);
  CancellationToken stopped;
  stopped.request(StopReason::cancelled);
  ::supple::testing::expect_cancelled(StopReason::cancelled, [&] { analyse(matrix, {}, stopped); });
  use_helper_processes(nullptr);
  EXPECT_EQ(quick.old_index,
            analyse_here(n, matrix.outerIndexPtr(), matrix.innerIndexPtr(), {}, OrderingSearch::quick).old_index);
  EXPECT_EQ(here.old_index, there.old_index);
  EXPECT_EQ(here.first, there.first);
  EXPECT_EQ(here.row_begin, there.row_begin);
  EXPECT_EQ(here.rows, there.rows);
  EXPECT_EQ(here.entries, there.entries);
}

// Nested dissection orders a large grid with a sparser factor, which the quick search does not look for while the
// factor fills little.
TEST(SymbolicAnalysis, OfAQuickSearchOrdersByMinimumDegreeWhereTheFactorFillsLittle) {
  const SparseMatrix matrix = grid_matrix(60);
  const int n = static_cast<int>(matrix.rows());
  const auto by = [&](OrderingSearch search) {
    return analyse_here(n, matrix.outerIndexPtr(), matrix.innerIndexPtr(), {}, search);
  };
  const SymbolicAnalysis quick = by(OrderingSearch::quick);
  const SymbolicAnalysis thorough = by(OrderingSearch::thorough);
  std::vector<int> sorted = quick.old_index;
  std::sort(sorted.begin(), sorted.end());
  for (int i = 0; i < n; ++i) ASSERT_EQ(sorted[static_cast<std::size_t>(i)], i);
  EXPECT_GT(quick.entries, thorough.entries) << "both searches found the same ordering";
  EXPECT_LT(quick.entries, 2 * thorough.entries);
}

TEST(ShiftedCholesky, SolvesAlikeByAQuickOrdering) {
  const SparseMatrix matrix = grid_matrix(60);
  const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(matrix.rows(), -1, 1);
  ShiftedCholesky thorough;
  ShiftedCholesky quick;
  quick.use_fast_ordering();
  ASSERT_TRUE(thorough.factorize(matrix, 0));
  ASSERT_TRUE(quick.factorize(matrix, 0));
  EXPECT_LT((thorough.solve(right) - quick.solve(right)).norm(), 1e-12);
}

TEST(ShiftedCholesky, StopsBetweenFrontsAndWithinThem) {
  const SparseMatrix matrix = grid_matrix(40);
  ShiftedCholesky cholesky;
  CancellationToken token;
  cholesky.stop_with(token);
  ASSERT_TRUE(cholesky.factorize(matrix, 0));
  token.request(StopReason::deadline);
  ::supple::testing::expect_cancelled(StopReason::deadline, [&] { cholesky.factorize(matrix, 0); });
  Eigen::MatrixXd front = Eigen::MatrixXd::Identity(64, 64);
  EXPECT_FALSE(partial_cholesky(front.data(), 64, 64, 64, token));
  EXPECT_TRUE(partial_cholesky(front.data(), 64, 64, 64)) << "a positive definite matrix";
}

TEST(HessianEntries, StopWhileTheySortTheirPlaces) {
  HessianEntries entries;
  CancellationToken token;
  entries.stop_with(&token);
  for (int i = 0; i < 1000; ++i) entries.add(i, i, 1);
  token.request(StopReason::cancelled);
  ::supple::testing::expect_cancelled(StopReason::cancelled, [&] { entries.matrix(1000); });
}

TEST(HessianEntries, StopWhileTheyAreAddedAndServeAgainAfterwards) {
  constexpr int n = 1000;
  constexpr int band = 100;
  const auto add_all = [](HessianEntries& entries) {
    for (int i = 0; i < n; ++i)
      for (int j = std::max(0, i - band); j <= i; ++j) entries.add(i, j, i == j ? 2 : -0.01);
  };
  HessianEntries undisturbed;
  add_all(undisturbed);
  const SparseMatrix expected = undisturbed.matrix(n);
  for (const bool while_added : {true, false}) {
    HessianEntries entries;
    CancellationToken token;
    entries.stop_with(&token);
    if (while_added) {
      token.request(StopReason::deadline);
      ::supple::testing::expect_cancelled(StopReason::deadline, [&] { add_all(entries); });
    } else {
      add_all(entries);
      token.request(StopReason::deadline);
      ::supple::testing::expect_cancelled(StopReason::deadline, [&] { entries.matrix(n); });
    }
    entries.stop_with(nullptr);
    for (int round = 0; round < 2; ++round) {
      entries.clear();
      add_all(entries);
      EXPECT_EQ((entries.matrix(n) - expected).norm(), 0) << while_added << ", round " << round;
    }
  }
}

}  // namespace
}  // namespace supple::numerics
