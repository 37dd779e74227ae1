#include "supple/budget/computation_memory.h"

#include <algorithm>
#include <utility>

#include "refusals.h"

namespace supple::budget {

ComputationMemory::ComputationMemory(MemoryBudget& budget, const CancellationToken& token)
    : budget_(budget), token_(token) {
  const Use uncounted(nullptr);  // counting an allocation of the list would lock the mutex again
  const std::lock_guard lock(budget_.mutex_);
  budget_.computations_.push_back(this);
}

ComputationMemory::~ComputationMemory() {
  const std::lock_guard lock(budget_.mutex_);
  std::erase(budget_.computations_, this);
  budget_.allocated_ -= held_;
  budget_.note_release(peak_);
}

void ComputationMemory::add(std::int64_t bytes) noexcept {
  const std::lock_guard lock(budget_.mutex_);
  // Clamped at 0: a computation that frees blocks of others gets no credit for them.
  const auto before = std::exchange(held_, std::max<std::int64_t>(held_ + bytes, 0));
  peak_ = std::max(peak_, held_);
  budget_.allocated_ += held_ - before;
  if (held_ <= before) return;
  if (held_ > max_held()) return stop(StopCause::request_limit, held_, budget_.max_per_request_);
  if (budget_.in_use() > budget_.total_) stop_largest(0);
}

bool ComputationMemory::allows(std::int64_t bytes) noexcept {
  const std::lock_guard lock(budget_.mutex_);
  if (held_ + bytes > max_held()) {
    stop(StopCause::request_limit, held_ + bytes, budget_.max_per_request_);
    return false;
  }
  const auto all = budget_.in_use() + bytes;
  if (all <= budget_.total_) return true;
  stop_largest(bytes);
  if (is_stopping()) return false;
  // The largest computation is about to free its memory. Until then the reserve is allowed.
  if (all <= budget_.total_ + report_reserve(budget_.total_)) return true;
  stop(StopCause::total_limit, all, budget_.total_);
  return false;
}

std::int64_t ComputationMemory::max_held() const noexcept {
  const auto limit = budget_.max_per_request_;
  return is_reporting() ? limit + report_reserve(limit) : limit;
}

std::int64_t ComputationMemory::peak() const {
  const std::lock_guard lock(budget_.mutex_);
  return peak_;
}

void ComputationMemory::stop(StopCause why, std::int64_t needed, std::int64_t limit) noexcept {
  if (is_stopping() || (is_reporting() && needed <= limit + report_reserve(limit))) return;
  stop_cause_ = why;
  needed_ = needed;
  token_.request(StopReason::memory);
}

void ComputationMemory::stop_largest(std::int64_t wanted) noexcept {
  const auto size = [&](const ComputationMemory* one) { return one->held_ + (one == this ? wanted : 0); };
  ComputationMemory* largest = this;
  for (auto* const other : budget_.computations_)
    if (size(other) > size(largest)) largest = other;
  largest->stop(StopCause::total_limit, budget_.in_use() + wanted, budget_.total_);
}

void ComputationMemory::stop_largest_in(MemoryBudget& budget, std::int64_t resident,
                                        std::int64_t max_resident) noexcept {
  const bool is_urgent = resident > max_resident + report_reserve(max_resident);
  ComputationMemory* largest = nullptr;
  bool one_is_stopping = false;
  for (auto* const one : budget.computations_) {
    if (one->is_stopping() || (one->is_reporting() && !is_urgent)) {
      one_is_stopping = true;
    } else if (!largest || one->held_ > largest->held_) {
      largest = one;
    }
  }
  if (largest && (is_urgent || !one_is_stopping)) largest->stop(StopCause::process_limit, resident, max_resident);
}

void ComputationMemory::throw_if_stopped() const {
  StopCause stop_cause = StopCause::none;
  std::int64_t needed = 0;
  {
    const std::lock_guard lock(budget_.mutex_);
    stop_cause = stop_cause_;
    needed = needed_;
  }
  // The mutex is released, because counting the allocations for the texts locks it.
  if (stop_cause == StopCause::request_limit)
    refuse_one(budget_.max_per_request_, needed, "what it has computed so far");
  if (stop_cause == StopCause::process_limit) refuse_process(needed, "this computation, which held most");
  if (stop_cause == StopCause::total_limit) refuse_all(budget_.total_, needed, "what this one has computed so far");
}

}  // namespace supple::budget
