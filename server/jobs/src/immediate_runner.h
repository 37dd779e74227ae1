#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>

#include "abandonment.h"
#include "compute_slots.h"
#include "sessions.h"

namespace supple::jobs {

/// Runs computations on the threads of their callers, within compute slots. While its mutex is locked, nothing is
/// called.
class ImmediateRunner {
 public:
  ImmediateRunner(const QueueOptions& options, Watchdog& watchdog, Sessions& sessions, const AbandonmentLog& log)
      : options_(options), watchdog_(watchdog), sessions_(sessions), log_(log), slots_(options.immediate) {}

  /// Does what JobQueue::run_now says.
  Result run(const Computation& computation, Waiting waiting, Profile* profile);

  /// Computations that run or wait for a slot.
  int in_use() const { return slots_.in_use(); }
  std::size_t abandoned() const;

  /// Refuses further computations.
  void refuse();
  /// Waits until no computation runs except abandoned ones, or until `end`.
  void wait_until_idle(Clock::time_point end) const;
  void stop_all();

 private:
  struct Running {
    CancellationToken token;
    std::optional<Watchdog::Overdue> abandoned{};
  };
  class Place;

  std::uint64_t enter(const CancellationToken& token);
  /// Returns since when the computation was overdue, if it was abandoned.
  std::optional<Watchdog::Overdue> leave(std::uint64_t number);
  /// Returns whether others get what the computation holds of its caller (see Waiting::answer_for_it).
  bool abandon(std::uint64_t number, const Watchdog::Overdue& overdue);

  const QueueOptions& options_;
  Watchdog& watchdog_;
  Sessions& sessions_;
  const AbandonmentLog& log_;
  ComputeSlots slots_;
  mutable std::mutex mutex_;
  mutable std::condition_variable idle_;
  std::map<std::uint64_t, Running> running_;
  std::uint64_t last_number_ = 0;
  std::size_t abandoned_ = 0;  // number of those in running_ that are abandoned
  bool refusing_ = false;
};

}  // namespace supple::jobs
