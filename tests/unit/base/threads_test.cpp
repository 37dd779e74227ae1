#include "supple/base/threads.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
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
  testing::expect_cancelled(StopReason::cancelled, [] {
    parallel_for(1000, [](int i) {
      if (i == 617) throw Cancelled(StopReason::cancelled);
    });
  });
}

TEST(ParallelFor, WithinAnotherWaitsForItsOwnPartsOnly) {
  static thread_local int within = 0;
  set_thread_count(6);
  std::atomic<int> entered_twice = 0;
  // The default arena has no more threads than the machine has cores.
  tbb::task_arena(6).execute([&] {
    parallel_for(200, [&](int i) {
      if (within > 0) ++entered_twice;
      ++within;
      parallel_for(i % 7, [](int k) { std::this_thread::sleep_for(std::chrono::microseconds(20 + 400 * (k % 2))); });
      --within;
    });
  });
  set_thread_count(0);
  EXPECT_EQ(entered_twice, 0) << "a part of the outer loop began while another waited on the same thread";
}

TEST(ParallelFor, RunsAllPartsThoughALoopAroundItEndsWithAnException) {
  const auto soon = [](const auto& condition) {
    for (int k = 0; k < 5000 && !condition(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return condition();
  };
  set_thread_count(2);
  std::atomic<bool> is_within = false, is_ending = false, was_beside = false;
  std::atomic<int> parts = 0;
  constexpr int all = 100;
  const auto outer = [&](int i) {
    if (i == 1) {
      was_beside = soon([&] { return is_within.load(); });
      is_ending = true;
      throw std::runtime_error("the outer loop ends");
    }
    parallel_for(all, [&](int k) {
      is_within = true;
      if (k == 0 && soon([&] { return is_ending.load(); })) std::this_thread::sleep_for(std::chrono::milliseconds(50));
      ++parts;
    });
    EXPECT_EQ(parts, all) << "the inner loop returned before its end";
  };
  tbb::task_arena(2).execute([&] { EXPECT_THROW(parallel_for(2, outer), std::runtime_error); });
  set_thread_count(0);
  if (was_beside) {
    EXPECT_EQ(parts, all);
  }
}

TEST(Threads, AreCountedInOnePlace) {
  set_thread_count(1);
  EXPECT_EQ(thread_count(), 1);
  set_thread_count(0);
  EXPECT_GE(thread_count(), 1);
}

}  // namespace
}  // namespace supple
