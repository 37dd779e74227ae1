#pragma once

#include <chrono>

namespace supple::routes {

/// Chooses the intermediate states of a computation that are written: the first one, and then one in each period in
/// which clients of a job can see one.
class StatePace {
 public:
  /// Whether the state that has been reached now is written.
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
