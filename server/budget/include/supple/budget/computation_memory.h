#pragma once

#include <atomic>
#include <cstdint>

#include "supple/base/cancellation.h"
#include "supple/base/memory_account.h"
#include "supple/budget/memory.h"

namespace supple::budget {

/// What one computation has allocated, held against the limits of a budget.
///
/// A computation that holds more than one request may have is stopped. Where all together hold more than the budget,
/// the one that holds most is stopped, not the one that happens to ask next. A stop is a request of the token; a large
/// block that would go beyond a limit is refused at once. Counts where the program's malloc tells accounts of what it
/// does (counting_malloc.cpp), and nothing elsewhere. The token and the budget must outlive it.
class ComputationMemory final : public MemoryAccount {
 public:
  ComputationMemory(MemoryBudget& budget, const CancellationToken& token);
  ~ComputationMemory() override;
  ComputationMemory(const ComputationMemory&) = delete;
  ComputationMemory& operator=(const ComputationMemory&) = delete;

  void add(std::int64_t bytes) noexcept override;
  bool allows(std::int64_t bytes) noexcept override;

  /// The most bytes that it has held.
  std::int64_t peak() const;
  /// Throws the problem for which it was stopped, if it was: "request.too_much_memory" (413) beyond the limit of one
  /// request, "server.out_of_memory" (503) where all together needed more than there is.
  void throw_if_stopped() const;

 private:
  friend class MemoryBudget;
  enum class Stopped { no, beyond_its_own, beyond_all, beyond_the_process };

  /// All under the budget's mutex.
  void stop(Stopped why, std::int64_t needed) noexcept;
  void stop_largest(std::int64_t wanted) noexcept;
  /// Where the process has `resident` bytes and may have `most`. One that is stopping already has time to end, unless
  /// there is none left.
  static void stop_largest_of(MemoryBudget& budget, std::int64_t resident, std::int64_t most) noexcept;

  MemoryBudget& budget_;
  const CancellationToken token_;
  std::int64_t held_ = 0;
  std::int64_t peak_ = 0;
  Stopped stopped_ = Stopped::no;
  std::int64_t needed_ = 0;  // bytes that it, or all together, would have held
};

}  // namespace supple::budget
