#include "supple/base/stop_pace.h"

#include <gtest/gtest.h>

#include "supple/base/error.h"
#include "supple/base/random.h"
#include "support/expect_error.h"

namespace supple {
namespace {

TEST(StopPace, LooksAtTheTokenWithinSomeThousandCalls) {
  const CancellationToken token;
  StopPace pace(token);
  for (int i = 0; i < 100'000; ++i) pace.check();
  token.request(StopReason::cancelled);
  testing::expect_cancelled(StopReason::cancelled, [&pace] {
    for (int i = 0; i < 20'000; ++i) pace.check();
  });
}

TEST(SortStoppably, SortsAnyNumberOfValuesAndStopsWhenAsked) {
  const CancellationToken token;
  for (const int count : {0, 1, 1000, 65'536, 65'537, 300'001}) {
    RandomStream random("sort", static_cast<std::uint64_t>(count));
    std::vector<int> values(static_cast<std::size_t>(count));
    for (int& value : values) value = random.below(count / 2 + 1);
    std::vector<int> wanted = values;
    std::sort(wanted.begin(), wanted.end(), std::greater<>());
    sort_stoppably(values, token, std::greater<>());
    EXPECT_EQ(values, wanted) << count;
  }
  token.request(StopReason::deadline);
  std::vector<int> values(10, 0);
  testing::expect_cancelled(StopReason::deadline, [&] { sort_stoppably(values, token); });
}

}  // namespace
}  // namespace supple
