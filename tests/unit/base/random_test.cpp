#include "supple/base/random.h"

#include <gtest/gtest.h>

#include <vector>

namespace supple {
namespace {

// The expected numbers come from an independent implementation in Python of the published algorithms.
TEST(RandomStream, GivesTheSameNumbersOnEveryMachine) {
  RandomStream stream("points", 7);
  EXPECT_EQ(stream.next(), 0x6b443f31dfecf96aULL);
  EXPECT_EQ(stream.next(), 0xc57872ce92ae954eULL);
  EXPECT_EQ(stream.next(), 0x3d55226eae3d50eaULL);
}

TEST(RandomStream, DependsOnTheNameAndOnTheSeed) {
  const std::uint64_t first = RandomStream("points", 7).next();
  EXPECT_EQ(RandomStream("points", 7).next(), first);
  EXPECT_NE(RandomStream("points", 8).next(), first);
  EXPECT_NE(RandomStream("pointz", 7).next(), first);
}

TEST(RandomStream, UniformNumbersFillTheUnitInterval) {
  RandomStream stream("uniform", 1);
  double sum = 0, low = 1, high = 0;
  constexpr int n = 100'000;
  for (int i = 0; i < n; ++i) {
    const double u = stream.uniform();
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    sum += u;
    low = std::min(low, u);
    high = std::max(high, u);
  }
  EXPECT_NEAR(sum / n, 0.5, 0.005);
  EXPECT_LT(low, 1e-3);
  EXPECT_GT(high, 1 - 1e-3);
}

TEST(RandomStream, UniformNumbersStayBetweenTheirBounds) {
  RandomStream stream("bounds", 1);
  for (int i = 0; i < 1000; ++i) {
    const double u = stream.uniform(-3, -1);
    ASSERT_GE(u, -3);
    ASSERT_LT(u, -1);
  }
}

TEST(RandomStream, BelowReachesEveryValueAboutEquallyOften) {
  RandomStream stream("below", 1);
  std::vector<int> counts(6, 0);
  for (int i = 0; i < 60'000; ++i) ++counts.at(stream.below(6));
  for (const int count : counts) EXPECT_NEAR(count, 10'000, 500);
}

TEST(RandomStream, NormalNumbersHaveMeanZeroAndVarianceOne) {
  RandomStream stream("normal", 1);
  double sum = 0, squares = 0;
  constexpr int n = 100'000;
  for (int i = 0; i < n; ++i) {
    const double x = stream.normal();
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / n, 0, 0.02);
  EXPECT_NEAR(squares / n, 1, 0.03);
}

}  // namespace
}  // namespace supple
