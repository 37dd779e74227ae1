#include "supple/store/clock.h"

#include <gtest/gtest.h>

#include <chrono>

namespace supple::store {
namespace {

constexpr std::int64_t eight_days = 8LL * 86400 * 1000;  // ms

TEST(ProcessClock, TellsTheTimeOfTheStartPlusWhatHasPassedWhereverTheWallClockJumps) {
  std::int64_t wall = 1'700'000'000'000;
  std::int64_t elapsed = 12'345;
  const ProcessClock clock([&] { return wall; }, [&] { return elapsed; });
  EXPECT_EQ(clock.now(), 1'700'000'000'000);
  elapsed += 50;
  wall += eight_days;
  EXPECT_EQ(clock.now(), 1'700'000'000'050) << "forward";
  elapsed += 50;
  wall -= 2 * eight_days;
  EXPECT_EQ(clock.now(), 1'700'000'000'100) << "back";
}

TEST(ProcessClock, StartsWithTheMachinesTimeOfDay) {
  using namespace std::chrono;
  const auto before = duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count();
  const auto now = ProcessClock().now();
  const auto after = duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count();
  EXPECT_GE(now, before - 2);  // both clocks are truncated to whole milliseconds
  EXPECT_LE(now, after + 2);
}

}  // namespace
}  // namespace supple::store
