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

/// One thread that looks after all running computations: it requests a stop where a deadline has passed or a client has
/// hung up, and says so once where the computation goes on for a second nevertheless. A look costs about a microsecond
/// for each computation, every `period`; it sleeps while there is none.
class Watchdog {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds period{20};
  /// How long a computation may take to stop.
  static constexpr std::chrono::seconds patience{1};

  /// Why a computation should have stopped, and since when.
  struct Overdue {
    StopReason reason = StopReason::none;
    Clock::time_point since{};
  };

  struct Watch {
    CancellationToken token;
    std::optional<Clock::time_point> deadline;
    std::function<bool()> hung_up;  ///< may be empty; called from the watchdog's thread until the guard is gone
    /// May be empty. Called from the watchdog's thread, once at most, where the guard is there for `patience` after its
    /// deadline, or after its client has hung up.
    std::function<void(const Overdue&)> overdue{};
  };

  /// Keeps a watch until it is destroyed; afterwards `hung_up` and `overdue` are not called any more. The destructor
  /// waits for a call of `overdue`, which may therefore use all that outlives the guard, and must not wait for whoever
  /// destroys it.
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

  /// `look` is called every `period` while there are computations.
  explicit Watchdog(std::function<void()> look = {});
  ~Watchdog();
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

 private:
  struct Entry {
    Watch watch;
    Overdue stopped{};  ///< by this watchdog; no reason: not yet
    bool told = false;  ///< that it is overdue
  };

  std::uint64_t add(Watch watch);
  void remove(std::uint64_t id);
  void run();
  static void look_at(Entry& entry, Clock::time_point now);
  /// Without the mutex while it calls, so that `overdue` may take locks under which watches are added.
  void tell_overdue(std::unique_lock<std::mutex>& lock, Clock::time_point now);

  const std::function<void()> look_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::condition_variable told_;
  std::map<std::uint64_t, Entry> watches_;
  std::uint64_t next_id_ = 0;
  std::uint64_t telling_ = 0;  // the watch whose `overdue` is being called; 0: none
  bool asleep_ = false;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace supple::jobs
