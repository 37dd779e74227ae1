#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "supple/base/repeating_thread.h"

namespace supple {
namespace {

using namespace std::chrono_literals;

TEST(RepeatingThread, GoesOnWhateverAStepThrowsAndLogsTheFirstFailureInARow) {
  std::atomic<int> steps{0};
  std::mutex mutex;
  std::vector<std::string> log;
  {
    const RepeatingThread thread(
        "the thread",
        [&]() -> std::chrono::milliseconds {
          const int step = ++steps;
          if (step == 1) throw std::runtime_error("no file");
          if (step == 2) throw 2;
          if (step == 4) throw std::bad_alloc();
          return 1ms;
        },
        [&](const std::string& line) {
          const std::lock_guard lock(mutex);
          log.push_back(line);
          throw std::runtime_error("the log fails too");
        });
    while (steps < 5) std::this_thread::sleep_for(1ms);
  }
  ASSERT_EQ(log.size(), 2U);
  EXPECT_EQ(log[0], "the thread has failed, and tries again: no file");
  EXPECT_EQ(log[1], "the thread has failed, and tries again: " + std::string(std::bad_alloc().what()));
}

TEST(RepeatingThread, EndsWhileItWaits) {
  std::atomic<int> steps{0};
  const auto begin = std::chrono::steady_clock::now();
  {
    const RepeatingThread thread("the thread",
                                 [&] {
                                   ++steps;
                                   return 3'600'000ms;
                                 },
                                 {});
    while (steps < 1) std::this_thread::sleep_for(1ms);
  }
  EXPECT_EQ(steps, 1);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 10min);
}

}  // namespace
}  // namespace supple
