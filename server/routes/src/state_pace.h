#pragma once

#include <chrono>

namespace supple::routes {

/// Which intermediate states of a computation are written down: the first, and then as many as job queues show.
class StatePace {
 public:
  /// Whether the state that was reached now is one of them.
  bool is_due() {
    const auto now = std::chrono::steady_clock::now();
    if (any_ && now - last_ < period) return false;
    any_ = true;
    last_ = now;
    return true;
  }

 private:
  static constexpr std::chrono::milliseconds period{100};
  bool any_ = false;
  std::chrono::steady_clock::time_point last_{};
};

}  // namespace supple::routes
