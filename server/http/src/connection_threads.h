#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace supple::http {

/// Threads that answer requests: as many as are busy at the same time, up to a limit. They are made when they are
/// needed and stay.
class ConnectionThreads {
 public:
  explicit ConnectionThreads(std::size_t most) : most_(most) {}
  ~ConnectionThreads() { finish(); }
  ConnectionThreads(const ConnectionThreads&) = delete;
  ConnectionThreads& operator=(const ConnectionThreads&) = delete;

  void enqueue(std::function<void()> serve);
  /// One of the threads does nothing for others until `take_back`: there may be one more meanwhile.
  void lend();
  void take_back();
  /// Whether something waits for a thread.
  bool in_demand() const;
  /// Returns once everything has been done and the threads have ended.
  void finish();

 private:
  void work();
  /// Under the mutex: makes a thread if one is needed and allowed.
  void grow();

  std::size_t most_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::function<void()>> waiting_;
  std::vector<std::thread> threads_;
  std::size_t idle_ = 0;
  bool ending_ = false;
};

}  // namespace supple::http
