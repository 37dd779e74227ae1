#include "supple/store/stoppable_mutex.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "supple/base/error.h"

namespace supple::store {
namespace {

TEST(StoppableMutex, IsHeldByOneThreadAtATime) {
  constexpr int threads = 4;
  constexpr int turns = 2000;
  StoppableMutex mutex;
  std::atomic<bool> is_taken = false;
  std::atomic<int> meetings = 0;
  int count = 0;
  std::vector<std::thread> workers;
  workers.reserve(threads);
  for (int worker = 0; worker < threads; ++worker) {
    workers.emplace_back([&] {
      for (int turn = 0; turn < turns; ++turn) {
        const auto lock = lock_stoppably(mutex, {});
        if (is_taken.exchange(true)) ++meetings;
        ++count;
        is_taken = false;
      }
    });
  }
  for (auto& worker : workers) worker.join();
  EXPECT_EQ(meetings, 0);
  EXPECT_EQ(count, threads * turns);
}

TEST(StoppableMutex, AStopCallsAWaitingThreadAwayAndLeavesTheMutexToItsOwner) {
  StoppableMutex mutex;
  const CancellationToken cancellation;
  {
    const auto lock = lock_stoppably(mutex, {});
    std::thread waiting([&] { EXPECT_THROW(mutex.lock(cancellation), Cancelled); });
    cancellation.request(StopReason::cancelled);
    waiting.join();
  }
  EXPECT_TRUE(lock_stoppably(mutex, {}).owns_lock()) << "the owner freed it";
}

}  // namespace
}  // namespace supple::store
