#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

#include "supple/base/execution.h"

namespace supple::store {

/// A mutex that whoever waits for it can be called away from. std::timed_mutex would serve, but GCC 12's thread
/// sanitizer does not see how its try_lock_for locks, and reports each unlocking.
class StoppableMutex {
 public:
  /// Returns when the mutex is the caller's, and throws as throw_if_requested within some ten milliseconds of a stop
  /// if it is not by then.
  void lock(const CancellationToken& cancellation) {
    constexpr std::chrono::milliseconds look_at_token{10};  // a token wakes nobody
    std::unique_lock lock(mutex_);
    while (taken_) {
      cancellation.throw_if_requested();
      freed_.wait_for(lock, look_at_token);
    }
    taken_ = true;
  }
  void unlock() {
    {
      const std::lock_guard lock(mutex_);
      taken_ = false;
    }
    freed_.notify_one();
  }

 private:
  std::mutex mutex_;
  std::condition_variable freed_;
  bool taken_ = false;
};

/// The mutex, locked as above, until the answer goes.
inline std::unique_lock<StoppableMutex> lock_stoppably(StoppableMutex& mutex, const CancellationToken& cancellation) {
  mutex.lock(cancellation);
  return {mutex, std::adopt_lock};
}

}  // namespace supple::store
