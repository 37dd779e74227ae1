#include "supple/base/seeded_hash.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <set>
#include <vector>

namespace supple {
namespace {

TEST(SeededHash, IsTheSameForTheSameNumbersInTheSameOrder) {
  EXPECT_EQ(SeededHash::of(1, 2, 3), SeededHash::of(1, 2, 3));
  EXPECT_NE(SeededHash::of(1, 2, 3), SeededHash::of(3, 2, 1));
  EXPECT_NE(SeededHash::of(1, 2), SeededHash::of(1, 2, 0));
  EXPECT_EQ(SeededHash()(7), SeededHash::of(7));
  EXPECT_EQ(hash_seed(), hash_seed());
}

// If integers were their own hashes, these keys would all fall into one bucket of a table of a prime number of buckets.
TEST(SeededHash, SpreadsKeysThatWereChosenToMeet) {
  constexpr std::uint64_t buckets = 62233;
  std::vector<int> filled(buckets, 0);
  for (std::uint64_t k = 0; k < buckets; ++k) ++filled[SeededHash()(k * buckets) % buckets];
  EXPECT_LT(*std::ranges::max_element(filled),
            12);  // one value in 10^9 of a Poisson distribution of mean 1 is as large
}

TEST(SeededHash, ChangesHalfOfItsBitsWithAnyBitOfAKey) {
  for (int bit = 0; bit < 64; ++bit) {
    int changed = 0;
    for (std::uint64_t key = 0; key < 256; ++key)
      changed +=
          std::popcount(SeededHash()(key * 0x123456789ABCDEFU) ^
                        SeededHash()((key * 0x123456789ABCDEFU) ^ (std::uint64_t{1} << static_cast<unsigned>(bit))));
    EXPECT_NEAR(changed / 256.0, 32, 4) << bit;
  }
}

// Cells of a plane, whose coordinates are small integers, have different hashes.
TEST(SeededHash, TellsCellsApart) {
  std::set<std::size_t> hashes;
  for (int x = -150; x < 150; ++x)
    for (int y = -150; y < 150; ++y) hashes.insert(SeededHash::of(std::int64_t{x}, std::int64_t{y}, 0U));
  EXPECT_EQ(hashes.size(), 90'000U);
}

}  // namespace
}  // namespace supple
