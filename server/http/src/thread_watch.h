#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace supple::http {

/// A thread of its own that says when one of the threads on which all requests depend is held: once when its silence
/// begins, and once, with its length, when it has ended.
class ThreadWatch {
 public:
  using Clock = std::chrono::steady_clock;

  struct Watched {
    std::string name;                          ///< "the thread that accepts connections"
    std::function<Clock::duration()> silence;  ///< how long nothing has been seen of it; any thread may call
  };

  /// Silences of less than `most` are normal; it looks ten times in that time. `tell` gets the lines.
  ThreadWatch(std::vector<Watched> threads, Clock::duration most, std::function<void(const std::string&)> tell);
  ~ThreadWatch();
  ThreadWatch(const ThreadWatch&) = delete;
  ThreadWatch& operator=(const ThreadWatch&) = delete;

 private:
  struct State {
    Watched watched;
    bool is_silent = false;
    Clock::duration longest{};  ///< of the silence that is going on
  };
  void run();
  void look_at(State& state) const;

  std::vector<State> threads_;
  const Clock::duration most_;
  const std::function<void(const std::string&)> tell_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace supple::http
