#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "supple/base/repeating_thread.h"

namespace supple::http {

/// Watches threads on which all requests depend, on a thread of its own. It warns when the silence of one exceeds a
/// limit, and again, with the length of the silence, once it has ended.
class ThreadWatch {
 public:
  using Clock = std::chrono::steady_clock;

  struct Watched {
    std::string name;                          ///< for example "the thread that accepts connections"
    std::function<Clock::duration()> silence;  ///< time since the thread last ran; any thread may call it
  };

  /// Each thread is checked ten times in `max_silence`. `warn` gets lines for the log.
  ThreadWatch(std::vector<Watched> threads, Clock::duration max_silence, std::function<void(const std::string&)> warn);

 private:
  struct State {
    Watched watched;
    bool is_silent = false;
    Clock::duration longest{};  ///< length of the current silence so far
  };
  void check(State& state) const;

  std::vector<State> threads_;
  const Clock::duration max_silence_;
  const std::function<void(const std::string&)> warn_;
  std::optional<RepeatingThread> thread_;
};

}  // namespace supple::http
