#include "supple/jobs/compute_slots.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "supple/base/error.h"

namespace supple::jobs {
namespace {

TEST(ComputeSlots, NeverRunMoreThanTheirNumber) {
  ComputeSlots slots(3);
  std::atomic<int> running{0};
  std::atomic<int> most{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < 16; ++i) {
    threads.emplace_back([&] {
      for (int j = 0; j < 20; ++j) {
        const ComputeSlots::Slot slot(slots, {});
        const int now = ++running;
        int seen = most;
        while (now > seen && !most.compare_exchange_weak(seen, now)) {
        }
        std::this_thread::sleep_for(std::chrono::microseconds(100));
        --running;
      }
    });
  }
  for (auto& thread : threads) thread.join();
  EXPECT_LE(most, 3);
  EXPECT_GE(most, 2);
  EXPECT_EQ(slots.in_use(), 0);
}

TEST(ComputeSlots, LetGoOfAWaitingComputationThatIsCancelled) {
  ComputeSlots slots(1);
  const ComputeSlots::Slot taken(slots, {});
  const CancellationToken token;
  std::thread canceller([&] {
    while (slots.in_use() < 2) std::this_thread::yield();
    token.request(StopReason::cancelled);
  });
  EXPECT_THROW(ComputeSlots::Slot(slots, token), Error);
  canceller.join();
  EXPECT_EQ(slots.in_use(), 1);
}

}  // namespace
}  // namespace supple::jobs
