#pragma once

#include <condition_variable>
#include <mutex>

namespace supple {

/// A gate at which computations wait that do not check for a stop request. They go on when a test opens it.
class Gate {
 public:
  /// Waits until the gate is open for one more. Called by a computation.
  void pass() {
    std::unique_lock lock(mutex_);
    ++arrived_;
    changed_.notify_all();
    changed_.wait(lock, [this] { return open_ > 0; });
    --open_;
  }
  /// Waits until so many computations have arrived in all.
  void wait_for(int arrived) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return arrived_ >= arrived; });
  }
  /// Number of computations that have arrived in all.
  int arrived() {
    const std::lock_guard lock(mutex_);
    return arrived_;
  }
  /// Lets `count` computations go on.
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
