#include "supple/base/sobol.h"

#include <gtest/gtest.h>

#include <set>

namespace supple {
namespace {

constexpr auto dimensions = static_cast<std::size_t>(SobolSequence::max_dimensions);

TEST(Sobol, HasOnePointInEachStratumOfEveryAxis) {
  for (const std::uint64_t seed : {1U, 99U}) {
    const SobolSequence sequence("strata", seed);
    for (const int m : {1, 4, 9}) {
      const std::uint32_t n = 1U << m;
      for (const std::uint32_t start : {0U, n, 5 * n}) {
        for (std::size_t d = 0; d < dimensions; ++d) {
          std::set<int> strata;
          for (std::uint32_t i = start; i < start + n; ++i)
            strata.insert(static_cast<int>(sequence.point(i)[d] * static_cast<double>(n)));
          EXPECT_EQ(strata.size(), n) << "axis " << d << ", 2^" << m << " points from " << start;
        }
      }
    }
  }
}

TEST(Sobol, HasOnePointInEachRectangleOfEqualAreaOfTheFirstTwoAxes) {
  const SobolSequence sequence("net", 3);
  constexpr int m = 8;
  for (int first = 0; first <= m; ++first) {
    std::set<std::pair<int, int>> rectangles;
    for (std::uint32_t i = 0; i < (1U << m); ++i) {
      const auto point = sequence.point(i);
      rectangles.emplace(static_cast<int>(point[0] * (1 << first)), static_cast<int>(point[1] * (1 << (m - first))));
    }
    EXPECT_EQ(rectangles.size(), 1U << m) << "2^" << first << " columns";
  }
}

/// The test integrates a product over the unit cube. The error would be large for axes that repeat each other.
TEST(Sobol, IntegratesProductsOfAnyTwoAxes) {
  const SobolSequence sequence("products", 5);
  constexpr std::uint32_t n = 4096;
  for (std::size_t a = 0; a < dimensions; ++a) {
    for (std::size_t b = a + 1; b < dimensions; ++b) {
      double sum = 0;
      for (std::uint32_t i = 0; i < n; ++i) sum += sequence.point(i)[a] * sequence.point(i)[b];
      EXPECT_NEAR(sum / n, 0.25, 1e-3) << a << " and " << b;
    }
  }
}

TEST(Sobol, DependsOnNameAndSeedOnly) {
  EXPECT_EQ(SobolSequence("a", 1).point(17), SobolSequence("a", 1).point(17));
  EXPECT_NE(SobolSequence("a", 1).point(17), SobolSequence("a", 2).point(17));
  EXPECT_NE(SobolSequence("a", 1).point(17), SobolSequence("b", 1).point(17));
}

TEST(Sobol, NeverReachesTheBorder) {
  const SobolSequence sequence("border", 8);
  for (std::uint32_t i = 0; i < 2000; ++i) {
    for (const double x : sequence.point(i)) {
      EXPECT_GT(x, 0);
      EXPECT_LT(x, 1);
    }
  }
}

}  // namespace
}  // namespace supple
