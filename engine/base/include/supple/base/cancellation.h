#pragma once

#include <atomic>
#include <exception>
#include <memory>

#include "supple/base/watched_work.h"

namespace supple {

/// `memory`: a limit of memory is reached. An optimization that has a result answers a stop for `deadline` or `memory`
/// with it (CancellationToken::resume); nobody waits for the result after the others.
enum class StopReason { none = 0, cancelled = 1, deadline = 2, shutdown = 3, superseded = 4, memory = 5 };

/// Ends a computation that was asked to stop. It is no Error: code that handles a failed computation must not take a
/// stopped one for it.
class Cancelled : public std::exception {
 public:
  explicit Cancelled(StopReason reason) noexcept : reason_(reason) {}

  StopReason reason() const noexcept { return reason_; }
  const char* what() const noexcept override;

 private:
  StopReason reason_;
};

/// A flag that a computation shares with those who may stop it.
///
/// Copies share the flag. `request` may be called from any thread, and the first reason wins. Behind a reason that may
/// be taken back, `deadline` or `memory`, the first other one is noted, which stands once the first has been taken
/// back. The engine has no clock, so that the owner of a deadline has to request the stop. Long loops call
/// `throw_if_requested` at least every few milliseconds; it costs one relaxed load.
class CancellationToken {
 public:
  CancellationToken() : reasons_(std::make_shared<std::atomic<unsigned>>(0)) {}

  void request(StopReason reason) const noexcept;
  StopReason reason() const noexcept {
    return static_cast<StopReason>(reasons_->load(std::memory_order_relaxed) % later_reason);
  }
  bool requested() const noexcept { return reason() != StopReason::none; }
  /// Takes back the stop that was requested for `reason`, so that a computation can report the best of what it has
  /// found. The report has to be short, because the owner of the deadline requests the stop again some time later, and
  /// others may request it at once. What the token was asked for meanwhile, by which nobody waits for a report, stands
  /// then: a cancellation, a shutdown or a later request of the session. Returns false, and changes nothing, if no stop
  /// was requested for that reason.
  bool resume(StopReason reason) const noexcept;

  /// Throws Cancelled once a stop is requested.
  void throw_if_requested() const {
    WatchedWork::checked();
    if (const StopReason why = reason(); why != StopReason::none) throw Cancelled(why);
  }

 private:
  /// Factor of the reason that stands once the first one has been taken back. It is above every reason.
  static constexpr unsigned later_reason = 16;

  std::shared_ptr<std::atomic<unsigned>> reasons_;
};

}  // namespace supple
