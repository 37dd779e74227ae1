#include "thread_watch.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <string>
#include <vector>

namespace supple::http {
namespace {

using namespace std::chrono_literals;

/// Two watched threads whose silence the test sets, and the warnings about them.
class ThreadWatchTest : public ::testing::Test {
 protected:
  static constexpr auto patience = 100s;

  ThreadWatch::Watched watched(std::size_t which) {
    return {which == 0 ? "the first" : "the second", [this, which] {
              const std::lock_guard lock(mutex_);
              ++looks_;
              changed_.notify_all();
              return ThreadWatch::Clock::duration(silence_.at(which));
            }};
  }
  void set(std::size_t which, std::chrono::seconds silence) {
    const std::lock_guard lock(mutex_);
    silence_.at(which) = silence;
  }
  /// All warnings so far, after both threads have been checked with their current silence.
  std::vector<std::string> lines() {
    std::unique_lock lock(mutex_);
    // Two threads in three passes: one that may have begun before this call, a complete one, and a third whose end
    // shows that the warnings of the second have been recorded.
    const int looks = looks_ + 6;
    EXPECT_TRUE(changed_.wait_for(lock, patience, [&] { return looks_ >= looks; }));
    return told_;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::array<std::chrono::seconds, 2> silence_{};
  int looks_ = 0;
  std::vector<std::string> told_;
  ThreadWatch watch_{{watched(0), watched(1)}, 100ms, [this](const std::string& line) {
                       const std::lock_guard lock(mutex_);
                       told_.push_back(line);
                     }};
};

TEST_F(ThreadWatchTest, SaysNothingOfThreadsThatAreSeen) { EXPECT_TRUE(lines().empty()); }

TEST_F(ThreadWatchTest, SaysOnceThatASilenceBeginsAndOnceHowLongItWas) {
  set(0, 10s);
  EXPECT_EQ(lines(), std::vector<std::string>{"the first has been silent for 10.0 s"});
  set(0, 12s);
  EXPECT_EQ(lines().size(), 1U);
  set(0, 0s);
  EXPECT_EQ(lines().size(), 2U);
  EXPECT_EQ(lines().at(1), "the first was silent for 12.0 s");
}

TEST_F(ThreadWatchTest, TellsThreadsAndTheirSilencesApart) {
  set(0, 10s);
  lines();
  set(1, 3s);
  lines();
  set(0, 0s);
  lines();
  set(0, 2s);
  lines();
  set(0, 0s);
  const std::vector<std::string> expected{"the first has been silent for 10.0 s",
                                          "the second has been silent for 3.0 s", "the first was silent for 10.0 s",
                                          "the first has been silent for 2.0 s", "the first was silent for 2.0 s"};
  EXPECT_EQ(lines(), expected);
}

}  // namespace
}  // namespace supple::http
