#pragma once

#include <condition_variable>
#include <mutex>

namespace supple {

/// What computations wait at that look at no token: they go on once a test lets them.
class Gate {
 public:
  /// Called by a computation.
  void pass() {
    std::unique_lock lock(mutex_);
    ++arrived_;
    changed_.notify_all();
    changed_.wait(lock, [this] { return open_ > 0; });
    --open_;
  }
  /// Waits until so many have come in all.
  void wait_for(int arrived) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return arrived_ >= arrived; });
  }
  /// How many have come in.
  int arrived() {
    const std::lock_guard lock(mutex_);
    return arrived_;
  }
  /// Lets so many go on.
  void open(int count = 1) {
    const std::lock_guard lock(mutex_);
    open_ += count;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int arrived_ = 0;
  int open_ = 0;
};

}  // namespace supple
