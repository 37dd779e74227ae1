#pragma once

#include <chrono>

#include "supple/base/cancellation.h"
#include "supple/base/repeating_thread.h"

namespace supple::design {

/// The token of a part of a computation that may take only so long. A thread requests its stop soon after the whole
/// computation is to stop, for the same reason, or after the time has passed, with the reason `deadline`.
class TimeLimit {
 public:
  TimeLimit(const CancellationToken& whole, double seconds);
  const CancellationToken& token() const { return token_; }

 private:
  using Clock = std::chrono::steady_clock;

  void request_stop_when_due() const;

  const CancellationToken whole_;
  const CancellationToken token_;
  const Clock::time_point end_;
  RepeatingThread watch_;  ///< uses the others
};

}  // namespace supple::design
