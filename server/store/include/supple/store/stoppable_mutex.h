#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

#include "supple/base/execution.h"

namespace supple::store {

/// A mutex for which a thread can stop waiting when a stop is requested. std::timed_mutex would serve, but the thread
/// sanitizer of GCC 12 does not recognize how its try_lock_for locks, and reports each unlock.
class StoppableMutex {
 public:
  /// Returns when the caller has the mutex. If a stop is requested before that, it throws as throw_if_requested does,
  /// within some ten milliseconds.
  void lock(const CancellationToken& cancellation) {
    constexpr std::chrono::milliseconds check_interval{10};  // a stop request does not notify the condition variable
    std::unique_lock lock(mutex_);
    while (locked_) {
      cancellation.throw_if_requested();
      unlocked_.wait_for(lock, check_interval);
    }
    locked_ = true;
  }
  void unlock() {
    {
      const std::lock_guard lock(mutex_);
      locked_ = false;
    }
    unlocked_.notify_one();
  }

 private:
  std::mutex mutex_;
  std::condition_variable unlocked_;
  bool locked_ = false;
};

/// Locks the mutex as above. The returned object unlocks it when it is destroyed.
inline std::unique_lock<StoppableMutex> lock_stoppably(StoppableMutex& mutex, const CancellationToken& cancellation) {
  mutex.lock(cancellation);
  return {mutex, std::adopt_lock};
}

}  // namespace supple::store
