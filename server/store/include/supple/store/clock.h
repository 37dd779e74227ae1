#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace supple::store {

/// The wall clock at the start of the process plus the time that a monotonic clock has counted since. So time stamps
/// never run backward within one process, and ages are right whatever is done to the machine's clock. A clock that was
/// wrong at the start stays wrong by as much until the next start.
class ProcessClock {
 public:
  using Source = std::function<std::int64_t()>;

  /// Reads the machine's clocks. Time during which the machine sleeps counts.
  ProcessClock();
  /// Reads two clocks in milliseconds. `wall` counts since 1970 and is read once. `elapsed` counts since any moment and
  /// never runs backward.
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

/// Start of the machine in milliseconds since 1970, by the clock of now_milliseconds(). Another process computes the
/// same value unless the machine's clock is set in between.
std::int64_t machine_start_time();
/// Random id that the kernel gives to each start of the machine; empty where the system has none.
std::string machine_start_id();

}  // namespace supple::store
