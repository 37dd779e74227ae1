#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>

#include "supple/base/cancellation.h"

namespace supple::jobs {

/// Bounds how many immediate computations run at the same time; the others wait in the order of their arrival.
class ComputeSlots {
 public:
  explicit ComputeSlots(int count) : free_(count) {}

  /// Holds a slot for its lifetime.
  class Slot {
   public:
    /// Waits for a slot. Throws what the token throws if a stop is requested meanwhile.
    Slot(ComputeSlots& slots, const CancellationToken& token) : slots_(slots) { slots_.acquire(token); }
    ~Slot() { slots_.release(); }
    Slot(const Slot&) = delete;
    Slot& operator=(const Slot&) = delete;

   private:
    ComputeSlots& slots_;
  };

  /// Computations that run or wait.
  int in_use() const;

 private:
  void acquire(const CancellationToken& token);
  void release();

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::uint64_t> waiting_;
  std::uint64_t next_ticket_ = 0;
  int free_;
  int running_ = 0;
};

}  // namespace supple::jobs
