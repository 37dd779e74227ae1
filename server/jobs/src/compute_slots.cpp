#include "compute_slots.h"

#include <algorithm>
#include <chrono>

namespace supple::jobs {

std::list<std::string>::const_iterator ComputeSlots::next() const {
  const auto runs = [this](const std::string& client) {
    const auto found = running_of_client_.find(client);
    return found == running_of_client_.end() ? 0 : found->second;
  };
  return std::min_element(waiting_.begin(), waiting_.end(),
                          [&](const std::string& a, const std::string& b) { return runs(a) < runs(b); });
}

void ComputeSlots::acquire(const CancellationToken& token, const std::string& client) {
  constexpr std::chrono::milliseconds check_interval{20};  // a stop request does not notify the condition variable
  std::unique_lock lock(mutex_);
  const auto own = waiting_.insert(waiting_.end(), client);
  while (free() <= 0 || next() != own) {
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
  ++running_of_client_[client];
  if (free() > 0 && !waiting_.empty()) wake_.notify_all();
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
