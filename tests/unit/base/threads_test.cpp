#include "supple/base/threads.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

#include "support/expect_error.h"

namespace supple {
namespace {

TEST(ParallelFor, RunsTheBodyOnceForEachIndex) {
  std::vector<std::atomic<int>> runs(1000);
  parallel_for(1000, [&](int i) { ++runs[i]; });
  for (const auto& count : runs) EXPECT_EQ(count.load(), 1);
}

TEST(ParallelFor, OfNothingNeverRunsTheBody) {
  parallel_for(0, [](int) { FAIL(); });
}

TEST(ParallelFor, HandsAnExceptionToTheCaller) {
  testing::expect_error("job.cancelled", [] {
    parallel_for(1000, [](int i) {
      if (i == 617) throw Error("job.cancelled", "stop");
    });
  });
}

TEST(Threads, AreCountedInOnePlace) {
  set_thread_count(1);
  EXPECT_EQ(thread_count(), 1);
  set_thread_count(0);
  EXPECT_GE(thread_count(), 1);
}

}  // namespace
}  // namespace supple
