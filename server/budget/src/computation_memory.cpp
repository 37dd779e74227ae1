#include "supple/budget/computation_memory.h"

#include <algorithm>
#include <utility>

#include "refusals.h"

namespace supple::budget {

ComputationMemory::ComputationMemory(MemoryBudget& budget, const CancellationToken& token)
    : budget_(budget), token_(token) {
  const Use nobody(nullptr);  // what the list allocates is not to be counted under the mutex
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
  // Blocks of others that it frees are no credit.
  const auto before = std::exchange(held_, std::max<std::int64_t>(held_ + bytes, 0));
  peak_ = std::max(peak_, held_);
  budget_.allocated_ += held_ - before;
  if (held_ <= before) return;
  if (held_ > budget_.each_) return stop(Stopped::beyond_its_own, held_);
  if (budget_.in_use() > budget_.total_) stop_largest(0);
}

bool ComputationMemory::allows(std::int64_t bytes) noexcept {
  const std::lock_guard lock(budget_.mutex_);
  if (held_ + bytes > budget_.each_) {
    stop(Stopped::beyond_its_own, held_ + bytes);
    return false;
  }
  const auto all = budget_.in_use() + bytes;
  if (all <= budget_.total_) return true;
  stop_largest(bytes);
  if (stopped_ != Stopped::no) return false;
  // Another one is about to give back what it holds. What is asked for meanwhile has a margin.
  if (all <= budget_.total_ + budget_.total_ / 8) return true;
  stop(Stopped::beyond_all, all);
  return false;
}

std::int64_t ComputationMemory::peak() const {
  const std::lock_guard lock(budget_.mutex_);
  return peak_;
}

void ComputationMemory::stop(Stopped why, std::int64_t needed) noexcept {
  if (stopped_ != Stopped::no) return;
  stopped_ = why;
  needed_ = needed;
  token_.request(StopReason::cancelled);
}

void ComputationMemory::stop_largest(std::int64_t wanted) noexcept {
  const auto size = [&](const ComputationMemory* one) { return one->held_ + (one == this ? wanted : 0); };
  ComputationMemory* largest = this;
  for (auto* const other : budget_.computations_)
    if (size(other) > size(largest)) largest = other;
  largest->stop(Stopped::beyond_all, budget_.in_use() + wanted);
}

void ComputationMemory::stop_largest_of(MemoryBudget& budget, std::int64_t resident, std::int64_t most) noexcept {
  ComputationMemory* largest = nullptr;
  bool one_is_stopping = false;
  for (auto* const one : budget.computations_) {
    if (one->stopped_ != Stopped::no) {
      one_is_stopping = true;
    } else if (!largest || one->held_ > largest->held_) {
      largest = one;
    }
  }
  const bool urgent = resident > most + most / 8;
  if (largest && (urgent || !one_is_stopping)) largest->stop(Stopped::beyond_the_process, resident);
}

void ComputationMemory::throw_if_stopped() const {
  Stopped stopped = Stopped::no;
  std::int64_t needed = 0;
  {
    const std::lock_guard lock(budget_.mutex_);
    stopped = stopped_;
    needed = needed_;
  }
  // Outside of the mutex: what is allocated for the texts may have to be counted.
  if (stopped == Stopped::beyond_its_own) refuse_one(budget_.each_, needed, "what it has computed so far");
  if (stopped == Stopped::beyond_the_process) refuse_process(needed, "this computation, which held most");
  if (stopped == Stopped::beyond_all) refuse_all(budget_.total_, needed, "what this one has computed so far");
}

}  // namespace supple::budget
