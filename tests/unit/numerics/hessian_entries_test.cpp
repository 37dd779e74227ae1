#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>

#include "supple/base/random.h"
#include "supple/numerics/hessian_entries.h"
#include "test_functions.h"

namespace supple::numerics {
namespace {

struct Entry {
  int i;
  int j;
  double value;
};

Eigen::MatrixXd dense(const std::vector<Entry>& entries, int n) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  for (const Entry& e : entries) {
    matrix(e.i, e.j) += e.value;
    if (e.i != e.j) matrix(e.j, e.i) += e.value;
  }
  return matrix;
}

std::vector<Entry> random_entries(RandomStream& random, int n, int count) {
  std::vector<Entry> entries;
  for (int k = 0; k < count; ++k) entries.push_back({random.below(n), random.below(n), random.uniform(-1, 1)});
  return entries;
}

TEST(HessianEntries, AddUpToTheSymmetricMatrixInEitherOrderOfThePair) {
  RandomStream random("hessian_entries", 1);
  const std::vector<Entry> entries = random_entries(random, 9, 60);
  HessianEntries sum;
  for (const Entry& e : entries) sum.add(e.i, e.j, e.value);
  EXPECT_LT((Eigen::MatrixXd(sum.matrix(9)) - dense(entries, 9)).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(HessianEntries, TakeBlocksWhoseLastRowsAreTheBorders) {
  RandomStream random("hessian_entries", 7);
  // Degrees of freedom 2 and 5 are held, 7 and 8 are the border's.
  HessianEntries sum(Numbering{0, 1, -1, 2, 3, -1, 4});
  const std::vector<std::vector<std::int32_t>> blocks = {{0, 2, 3, 7, 8}, {1, 4, 6}, {7, 8}, {2, 5, 6, 8}, {3}};
  BorderedMatrix matrix;
  for (int round = 0; round < 3; ++round) {
    std::vector<Entry> entries;
    sum.clear();
    for (const auto& rows : blocks) {
      std::vector<double> lower;
      for (std::size_t k = 0; k < rows.size(); ++k)
        for (std::size_t l = 0; l <= k; ++l) {
          lower.push_back(random.uniform(-1, 1));
          entries.push_back({rows[k], rows[l], lower.back()});
        }
      sum.add_block(rows, lower.data());
    }
    sum.assemble(9, matrix);
    const Eigen::MatrixXd expected = dense(entries, 9);
    const std::vector<int> unknowns = {0, 1, 3, 4, 6, 7, 8};
    EXPECT_LT((dense(matrix) - expected(unknowns, unknowns)).cwiseAbs().maxCoeff(), 1e-14) << "round " << round;
  }
}

TEST(HessianEntries, FollowASequenceThatGrowsShrinksAndChangesInItsMiddle) {
  RandomStream random("hessian_entries", 2);
  HessianEntries sum(7);
  BorderedMatrix matrix;
  const std::vector<Entry> first = random_entries(random, 9, 40);
  std::vector<std::vector<Entry>> rounds = {first, first};
  rounds.push_back({first.begin(), first.begin() + 20});
  rounds.push_back(first);
  rounds.push_back(first);
  rounds.back().insert(rounds.back().begin() + 10, {3, 4, 0.5});
  rounds.push_back(random_entries(random, 9, 50));
  rounds.emplace_back();
  rounds.push_back(first);
  for (std::size_t round = 0; round < rounds.size(); ++round) {
    sum.clear();
    for (const Entry& e : rounds[round]) sum.add(e.i, e.j, e.value);
    sum.assemble(9, matrix);
    EXPECT_LT((dense(matrix) - dense(rounds[round], 9)).cwiseAbs().maxCoeff(), 1e-14) << "round " << round;
  }
}

TEST(HessianEntries, KeepAPlaceOnceSeenSoThatThePatternStays) {
  HessianEntries sum(3);
  BorderedMatrix matrix;
  for (const bool contact : {false, true, false, true}) {
    sum.clear();
    for (int i = 0; i < 3; ++i) sum.add(i, i, 2);
    if (contact) sum.add(2, 0, -1);
    sum.assemble(3, matrix);
    EXPECT_EQ(matrix.core.coeff(2, 0), contact ? -1 : 0);
  }
  EXPECT_EQ(matrix.core.nonZeros(), 4);
}

TEST(HessianEntries, LoseEmptyPlacesWhereTheyWouldOutgrowTheFilledOnes) {
  // A pair of unknowns that is another one each time: its old places must not gather.
  constexpr int n = 40;
  HessianEntries sum(n);
  BorderedMatrix matrix;
  for (int round = 0; round < 200; ++round) {
    sum.clear();
    for (int i = 0; i < n; ++i) sum.add(i, i, 2 + round);
    const int i = round % n;
    const int j = (7 * round + 3) % n;
    if (i != j) sum.add(i, j, -1);
    sum.assemble(n, matrix);
    EXPECT_LE(matrix.core.nonZeros(), 1.25 * (n + 1) + 1);
    Eigen::MatrixXd expected = (2 + round) * Eigen::MatrixXd::Identity(n, n);
    if (i != j) expected(i, j) = expected(j, i) = -1;
    ASSERT_EQ(dense(matrix), expected) << round;
  }
}

TEST(HessianEntries, FillAnewAMatrixThatHeldAnotherNumberOfEntries) {
  HessianEntries diagonal(3);
  HessianEntries full(3);
  BorderedMatrix shared;
  for (int round = 0; round < 3; ++round) {
    std::vector<Entry> entries;
    diagonal.clear();
    for (int i = 0; i < 3; ++i) {
      entries.push_back({i, i, 1.0 + i + round});
      diagonal.add(i, i, entries.back().value);
    }
    diagonal.assemble(3, shared);
    EXPECT_EQ(dense(shared), dense(entries, 3)) << "round " << round;
    full.clear();
    for (const Entry& e : entries) full.add(e.i, e.j, e.value);
    for (const Entry& e : {Entry{1, 0, 0.5}, Entry{2, 0, 0.25}, Entry{2, 1, -1}}) {
      full.add(e.i, e.j, e.value);
      entries.push_back(e);
    }
    full.assemble(3, shared);
    EXPECT_EQ(dense(shared), dense(entries, 3)) << "round " << round;
  }
}

TEST(HessianEntries, ForgetWhatWasNotAssembled) {
  HessianEntries sum(2);
  sum.add(0, 0, 5);
  sum.add(1, 0, 5);
  sum.clear();
  sum.add(0, 0, 1);
  BorderedMatrix matrix;
  sum.assemble(2, matrix);
  EXPECT_EQ(dense(matrix), (Eigen::Matrix2d() << 1, 0, 0, 0).finished());
}

TEST(HessianEntries, BlocksAddWhatTheirEntriesWould) {
  RandomStream random("hessian_entries", 3);
  constexpr int n = 40;
  HessianEntries blocks(n);
  HessianEntries single(n);
  BorderedMatrix matrix;
  BorderedMatrix expected;
  const auto same = [&] {
    blocks.assemble(n + 2, matrix);
    single.assemble(n + 2, expected);
    EXPECT_LT((dense(matrix) - dense(expected)).cwiseAbs().maxCoeff(), 1e-13);
  };
  using Rows = std::array<std::int32_t, 12>;
  std::vector<Rows> elements(8);
  for (auto& rows : elements)
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = static_cast<std::int32_t>(3 * k) + random.below(3);
  // Twice the same; an element less; entries between; another element in the middle; the first again.
  for (const int round : {0, 0, 1, 0, 2, 2, 3, 0, 0}) {
    blocks.clear();
    single.clear();
    for (std::size_t e = 0; e < elements.size(); ++e) {
      if (round == 1 && e == 5) continue;
      const Rows& rows = elements[round == 3 && e == 4 ? 6 : e];
      double lower[HessianEntries::entries_of(12)];
      for (double& value : lower) value = random.uniform(-1, 1);
      blocks.add_block(rows, lower);
      for (std::size_t k = 0, i = 0; k < rows.size(); ++k)
        for (std::size_t l = 0; l <= k; ++l, ++i) single.add(rows[k], rows[l], lower[i]);
      const double row[2] = {random.uniform(-1, 1), random.uniform(-1, 1)};
      blocks.add_row<2>(rows[0], n, row);
      for (int k = 0; k < 2; ++k) single.add(rows[0], n + k, row[k]);
      if (round == 2 && e % 3 == 0) {
        blocks.add(1, 39, 0.5);
        single.add(1, 39, 0.5);
      }
    }
    SCOPED_TRACE(round);
    same();
  }
}

TEST(HessianEntries, TakeBlocksOfOtherRowsAndSizesWhereOthersWere) {
  RandomStream random("hessian_entries", 5);
  constexpr int n = 30;
  HessianEntries sum(Numbering{0,  1,  -1, 2,  3,  4,  5,  6,  7,  8,  9,  10, -1, 11, 12,
                               13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27});
  const std::vector<int> free = [] {
    std::vector<int> rows;
    for (int i = 0; i < n; ++i)
      if (i != 2 && i != 12) rows.push_back(i);
    return rows;
  }();
  std::vector<std::vector<std::int32_t>> blocks(12);
  const auto another = [&](std::vector<std::int32_t>& rows) {
    rows.clear();
    for (std::int32_t row = random.below(6); row < n; row += 1 + random.below(9)) rows.push_back(row);
  };
  for (auto& rows : blocks) another(rows);
  BorderedMatrix matrix;
  for (int round = 0; round < 60; ++round) {
    // None, one, some or all others than before; in some rounds one more, one less, or a single entry between them.
    for (int k = 0; k < round % 4; ++k) another(blocks[static_cast<std::size_t>(random.below(12))]);
    if (round % 20 == 13) std::ranges::for_each(blocks, another);
    const bool shortened = round % 7 == 5;
    const int single = round % 5 == 3 ? random.below(12) : -1;
    std::vector<Entry> entries;
    sum.clear();
    for (std::size_t b = 0; b < blocks.size() - (shortened ? 1 : 0); ++b) {
      std::vector<double> lower;
      for (std::size_t k = 0; k < blocks[b].size(); ++k)
        for (std::size_t l = 0; l <= k; ++l) {
          lower.push_back(random.uniform(-1, 1));
          entries.push_back({blocks[b][k], blocks[b][l], lower.back()});
        }
      sum.add_block(blocks[b], lower.data());
      if (single != static_cast<int>(b)) continue;
      entries.push_back({7, 3, 0.5});
      sum.add(7, 3, 0.5);
    }
    if (round % 11 == 10) continue;  // not assembled: the next round has to forget it
    sum.assemble(n, matrix);
    ASSERT_LT((dense(matrix) - dense(entries, n)(free, free)).cwiseAbs().maxCoeff(), 1e-13) << "round " << round;
  }
}

TEST(HessianEntries, ForgetBlocksThatDidNotComeAgain) {
  // A block whose place in the sequence was taken by others must not be recognized there later.
  HessianEntries sum(6);
  BorderedMatrix matrix;
  const std::array<std::int32_t, 2> rows{4, 5};
  const double lower[3] = {1, 2, 3};
  const auto singles = [&](const std::vector<Entry>& entries) {
    for (const Entry& e : entries) sum.add(e.i, e.j, e.value);
  };
  const std::vector<Entry> others{{0, 1, 1}, {1, 1, 1}, {2, 1, 1}, {3, 1, 1}};
  singles({{0, 0, 1}});
  sum.add_block(rows, lower);
  sum.clear();
  singles(others);
  sum.clear();
  singles({others.front()});
  sum.add_block(rows, lower);
  sum.assemble(6, matrix);
  EXPECT_EQ(dense(matrix), dense({others.front(), {4, 4, 1}, {5, 4, 2}, {5, 5, 3}}, 6));
}

TEST(HessianEntries, DropWhatIsHeldAndNumberTheOthers) {
  RandomStream random("hessian_entries", 4);
  const Numbering numbering{0, -1, 1, 2, -1, 3, 4};
  const std::vector<int> free{0, 2, 3, 5, 6, 7, 8};  // two of the border at the end
  HessianEntries sum(numbering);
  BorderedMatrix matrix;
  for (int round = 0; round < 4; ++round) {
    sum.clear();
    std::vector<Entry> entries = random_entries(random, 9, 60);
    if (round == 1) entries.resize(20);
    for (const Entry& e : entries) sum.add(e.i, e.j, e.value);
    const std::array<std::int32_t, 3> rows{1, 2, 6};
    const double lower[6] = {1, 2, 3, 4, 5, 6};
    sum.add_block(rows, lower);
    for (int k = 0, i = 0; k < 3; ++k)
      for (int l = 0; l <= k; ++l, ++i)
        entries.push_back({rows[static_cast<std::size_t>(k)], rows[static_cast<std::size_t>(l)], lower[i]});
    sum.assemble(9, matrix);
    EXPECT_LT((dense(matrix) - dense(entries, 9)(free, free)).cwiseAbs().maxCoeff(), 1e-13) << "round " << round;
  }
}

}  // namespace
}  // namespace supple::numerics
