#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace supple::http {

/// A pool of threads that answer requests. Threads are started when they are needed, up to a limit, and run until
/// `finish`.
class ConnectionThreads {
 public:
  explicit ConnectionThreads(std::size_t max_threads) : max_threads_(max_threads) {}
  ~ConnectionThreads() { finish(); }
  ConnectionThreads(const ConnectionThreads&) = delete;
  ConnectionThreads& operator=(const ConnectionThreads&) = delete;

  void enqueue(std::function<void()> serve);
  /// Allows one thread more, while one is occupied by a late handler.
  void raise_limit();
  /// Undoes `raise_limit`, once the handler has returned.
  void lower_limit();
  /// Whether a task waits for a thread.
  bool has_waiting() const;
  /// Returns once all tasks are done and the threads have ended.
  void finish();

 private:
  /// The loop that each thread runs.
  void work();
  /// Starts a thread if one is needed and allowed. The caller holds the mutex.
  void grow();

  std::size_t max_threads_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::function<void()>> waiting_;
  std::vector<std::thread> threads_;
  std::size_t idle_ = 0;
  bool ending_ = false;
};

}  // namespace supple::http
