#include "compute_slots.h"

#include <algorithm>
#include <chrono>

namespace supple::jobs {

std::list<ComputeSlots::Waiting>::const_iterator ComputeSlots::next() const {
  const auto runs = [this](const std::string& client) {
    const auto found = running_of_client_.find(client);
    return found == running_of_client_.end() ? 0 : found->second;
  };
  return std::min_element(waiting_.begin(), waiting_.end(), [&](const Waiting& a, const Waiting& b) {
    return std::pair(a.priority, runs(a.client)) < std::pair(b.priority, runs(b.client));
  });
}

void ComputeSlots::acquire(const CancellationToken& token, const Waiting& waiting) {
  constexpr std::chrono::milliseconds check_interval{20};  // a stop request does not notify the condition variable
  std::unique_lock lock(mutex_);
  const auto own = waiting_.insert(waiting_.end(), waiting);
  while (free(waiting.priority) <= 0 || next() != own) {
    if (token.requested()) {
      waiting_.erase(own);
      wake_.notify_all();
      lock.unlock();
      token.throw_if_requested();
    }
    wake_.wait_for(lock, check_interval);
  }
  waiting_.erase(own);
  ++running_;
  ++running_of_client_[waiting.client];
  if (!waiting_.empty() && free(next()->priority) > 0) wake_.notify_all();
}

void ComputeSlots::release(const std::string& client, bool is_given_up) {
  const std::lock_guard lock(mutex_);
  --running_;
  if (is_given_up) --given_up_;
  if (const auto count = running_of_client_.find(client); --count->second == 0) running_of_client_.erase(count);
  if (!waiting_.empty()) wake_.notify_all();
}

void ComputeSlots::give_up_one() {
  const std::lock_guard lock(mutex_);
  ++given_up_;
  if (!waiting_.empty()) wake_.notify_all();
}

int ComputeSlots::in_use() const {
  const std::lock_guard lock(mutex_);
  return running_ + static_cast<int>(waiting_.size());
}

}  // namespace supple::jobs
