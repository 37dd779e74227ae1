#include "supple/jobs/compute_slots.h"

#include <algorithm>
#include <chrono>

namespace supple::jobs {

std::list<std::string>::const_iterator ComputeSlots::next() const {
  const auto runs = [this](const std::string& client) {
    const auto found = running_of_.find(client);
    return found == running_of_.end() ? 0 : found->second;
  };
  return std::min_element(waiting_.begin(), waiting_.end(),
                          [&](const std::string& a, const std::string& b) { return runs(a) < runs(b); });
}

void ComputeSlots::acquire(const CancellationToken& token, const std::string& client) {
  constexpr std::chrono::milliseconds look_at_token{20};  // a token wakes nobody
  std::unique_lock lock(mutex_);
  const auto mine = waiting_.insert(waiting_.end(), client);
  while (free() <= 0 || next() != mine) {
    if (token.requested()) {
      waiting_.erase(mine);
      wake_.notify_all();
      lock.unlock();
      token.throw_if_requested();
    }
    wake_.wait_for(lock, look_at_token);
  }
  waiting_.erase(mine);
  ++running_;
  ++running_of_[client];
  if (free() > 0 && !waiting_.empty()) wake_.notify_all();
}

void ComputeSlots::release(const std::string& client, bool overdue) {
  const std::lock_guard lock(mutex_);
  --running_;
  if (overdue) --overdue_;
  if (const auto of = running_of_.find(client); --of->second == 0) running_of_.erase(of);
  if (!waiting_.empty()) wake_.notify_all();
}

void ComputeSlots::give_up_one() {
  const std::lock_guard lock(mutex_);
  ++overdue_;
  if (!waiting_.empty()) wake_.notify_all();
}

int ComputeSlots::in_use() const {
  const std::lock_guard lock(mutex_);
  return running_ + static_cast<int>(waiting_.size());
}

}  // namespace supple::jobs
