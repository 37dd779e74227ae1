#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "supple/base/cancellation.h"

namespace supple::jobs {

/// One thread that watches all running computations. It requests the stop of a computation when its deadline has passed
/// or its client has hung up, and reports once if the computation goes on for a second nevertheless. A computation that
/// takes the stop back, because it reports the best that it has found (CancellationToken::resume), is stopped again
/// `report_time` after that. A check takes about a microsecond for each computation, every `period`; the thread
/// sleeps while there is none.
class Watchdog {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds period{20};
  /// Time that a computation may take to report the best that it has found by its deadline, from when it has taken the
  /// stop back.
  static constexpr std::chrono::milliseconds report_time{500};
  /// Time that a computation may take to stop. It begins again when it takes a deadline's stop back, and includes the
  /// time of the report then.
  static constexpr std::chrono::seconds patience{1};

  /// Why a computation should have stopped, and since when.
  struct Overdue {
    StopReason reason = StopReason::none;
    Clock::time_point since{};
  };

  struct Watch {
    CancellationToken token;
    std::optional<Clock::time_point> deadline;
    /// Whether the client has gone; may be empty. Called from the watchdog's thread until the guard is destroyed.
    std::function<bool()> hung_up;
    /// May be empty. Called from the watchdog's thread, at most once, if the guard still exists `patience` after the
    /// deadline has passed, its stop was taken back, or the client has hung up.
    std::function<void(const Overdue&)> overdue{};
    /// May be empty. Called from the watchdog's thread when the stop for the deadline is found taken back. It must not
    /// wait.
    std::function<void(Clock::time_point)> resumed{};
  };

  /// What is known of a watched computation. The caller reads the clock.
  struct Entry {
    Watch watch;
    Overdue stopped{};         ///< when and why the watchdog requested its stop; no reason: not yet
    bool is_reported = false;  ///< whether `overdue` was called
    std::optional<Clock::time_point> resumed_at{};  ///< when the stop for the deadline was found taken back

    /// Requests its stop if that is due.
    void check(Clock::time_point now);
    /// Whether it should have stopped `patience` ago.
    bool is_overdue(Clock::time_point now) const;
  };

  /// Keeps a watch until it is destroyed. After that `hung_up` and `overdue` are not called any more. The destructor
  /// waits for a running call of `overdue`. So that may use whatever outlives the guard, and must not wait for the
  /// thread that destroys the guard.
  class Guard {
   public:
    Guard(Watchdog& watchdog, Watch watch) : watchdog_(watchdog), id_(watchdog.add(std::move(watch))) {}
    ~Guard() { watchdog_.remove(id_); }
    Guard(const Guard&) = delete;
    Guard& operator=(const Guard&) = delete;

   private:
    Watchdog& watchdog_;
    std::uint64_t id_;
  };

  /// `at_each_check` is called every `period` while there are computations. What it throws is ignored.
  explicit Watchdog(std::function<void()> at_each_check = {});
  ~Watchdog();
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

 private:
  std::uint64_t add(Watch watch);
  void remove(std::uint64_t id);
  void run();
  /// Calls `overdue` with the mutex unlocked, since it may lock mutexes under which other threads add watches.
  void report_overdue(std::unique_lock<std::mutex>& lock, Clock::time_point now);

  const std::function<void()> at_each_check_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::condition_variable reported_;
  std::map<std::uint64_t, Entry> watches_;
  std::uint64_t last_id_ = 0;
  std::uint64_t reporting_ = 0;  // the watch whose `overdue` is being called; 0: none
  bool asleep_ = false;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace supple::jobs
