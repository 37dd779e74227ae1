#pragma once

#include <atomic>
#include <cstdint>

#include "supple/base/cancellation.h"
#include "supple/base/memory_account.h"
#include "supple/budget/memory.h"

namespace supple::budget {

/// Counts what one computation allocates, and enforces the limits of a budget.
///
/// A computation that exceeds the limit of one request is stopped. If all together exceed the budget, the largest one
/// is stopped, not the one that allocates last. A stop is requested through the token. A large block that would exceed
/// a limit is refused at once. A computation that has taken its stop back, because it reports the best that it has
/// found (CancellationToken::resume), has `report_reserve` more for that, and is stopped again beyond it. Nothing is
/// counted unless the program's malloc reports to accounts (counting_malloc.cpp). The budget must outlive this object.
class ComputationMemory final : public MemoryAccount {
 public:
  ComputationMemory(MemoryBudget& budget, const CancellationToken& token);
  ~ComputationMemory() override;
  ComputationMemory(const ComputationMemory&) = delete;
  ComputationMemory& operator=(const ComputationMemory&) = delete;

  void add(std::int64_t bytes) noexcept override;
  bool allows(std::int64_t bytes) noexcept override;

  /// The largest number of bytes allocated at one time.
  std::int64_t peak() const;
  /// Throws the problem for which the computation was stopped, if it was: "request.too_much_memory" (413) beyond the
  /// limit of one request, "server.out_of_memory" (503) beyond the limit of all requests or of the process.
  void throw_if_stopped() const;

 private:
  friend class MemoryBudget;
  /// Bytes beyond a limit that a computation may have for its report, and others while the largest one ends: an eighth.
  static constexpr std::int64_t report_reserve(std::int64_t limit) { return limit / 8; }
  /// The limit for which the computation was stopped.
  enum class StopCause { none, request_limit, total_limit, process_limit };

  // The caller of the following functions holds the budget's mutex.
  /// Whether it was stopped and has not taken that back.
  bool is_stopping() const noexcept { return stop_cause_ != StopCause::none && token_.requested(); }
  /// Whether it has taken its stop back.
  bool is_reporting() const noexcept { return stop_cause_ != StopCause::none && !token_.requested(); }
  /// The bytes that it may hold.
  std::int64_t max_held() const noexcept;
  /// Stops this computation because of `needed` bytes, unless it is stopping, or these are within the reserve of a
  /// report beyond `limit`.
  void stop(StopCause why, std::int64_t needed, std::int64_t limit) noexcept;
  /// Stops the largest computation of the budget. `wanted` bytes more are counted for this one.
  void stop_largest(std::int64_t wanted) noexcept;
  /// Stops the largest computation, because the process has `resident` bytes. While another one is stopping or reports,
  /// it does so only if `max_resident` is exceeded by more than the reserve.
  static void stop_largest_in(MemoryBudget& budget, std::int64_t resident, std::int64_t max_resident) noexcept;

  MemoryBudget& budget_;
  const CancellationToken token_;
  std::int64_t held_ = 0;
  std::int64_t peak_ = 0;
  StopCause stop_cause_ = StopCause::none;
  std::int64_t needed_ = 0;  // bytes that exceed the limit of stop_cause_
};

}  // namespace supple::budget
