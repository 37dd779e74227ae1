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
/// hung up. A look costs about a microsecond for each computation, every `period`; it sleeps while there is none.
class Watchdog {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds period{20};

  struct Watch {
    CancellationToken token;
    std::optional<Clock::time_point> deadline;
    std::function<bool()> hung_up;  ///< may be empty; called from the watchdog's thread until the guard is gone
  };

  /// Keeps a watch until it is destroyed; afterwards `hung_up` is not called any more.
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
  std::uint64_t add(Watch watch);
  void remove(std::uint64_t id);
  void run();

  const std::function<void()> look_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::map<std::uint64_t, Watch> watches_;
  std::uint64_t next_id_ = 0;
  bool asleep_ = false;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace supple::jobs
