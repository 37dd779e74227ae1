#include "supple/jobs/compute_slots.h"

#include <algorithm>
#include <chrono>

namespace supple::jobs {

void ComputeSlots::acquire(const CancellationToken& token) {
  constexpr std::chrono::milliseconds look_at_token{20};  // a token wakes nobody
  std::unique_lock lock(mutex_);
  const auto ticket = ++next_ticket_;
  waiting_.push_back(ticket);
  while (waiting_.front() != ticket || free_ == 0) {
    if (token.requested()) {
      waiting_.erase(std::find(waiting_.begin(), waiting_.end(), ticket));
      wake_.notify_all();
      lock.unlock();
      token.throw_if_requested();
    }
    wake_.wait_for(lock, look_at_token);
  }
  waiting_.pop_front();
  --free_;
  ++running_;
  if (free_ > 0 && !waiting_.empty()) wake_.notify_all();
}

void ComputeSlots::release() {
  const std::lock_guard lock(mutex_);
  ++free_;
  --running_;
  if (!waiting_.empty()) wake_.notify_all();
}

int ComputeSlots::in_use() const {
  const std::lock_guard lock(mutex_);
  return running_ + static_cast<int>(waiting_.size());
}

}  // namespace supple::jobs
