#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace supple::store {

/// The time of day without its jumps: the wall clock at the start, plus the time that has passed since by a clock that
/// nobody sets. So ages are true and time stamps never run backward within one process, whatever is done to the
/// machine's clock; a clock that was wrong at the start stays wrong by the same amount until the next one.
class ProcessClock {
 public:
  using Source = std::function<std::int64_t()>;

  /// Over the machine's clocks; time while the machine sleeps counts.
  ProcessClock();
  /// Over clocks in milliseconds: `wall` since 1970, asked once; `elapsed` since any moment, never backward.
  ProcessClock(const Source& wall, Source elapsed);

  /// Milliseconds since 1970. Any thread may call.
  std::int64_t now() const { return origin_ + elapsed_(); }
  /// Milliseconds since 1970 at which `elapsed` was zero.
  std::int64_t origin() const { return origin_; }

 private:
  Source elapsed_;
  std::int64_t origin_;  ///< milliseconds since 1970 at which `elapsed` was zero
};

/// Milliseconds since 1970 by a ProcessClock that starts with the first call.
std::int64_t now_milliseconds();

/// When the machine was started, in milliseconds since 1970 by that clock: another process sees the same until the
/// machine's clock is set.
std::int64_t machine_start();
/// Which start of the machine this is; empty where the system does not tell.
std::string machine_start_id();

}  // namespace supple::store
