#include "compute_slots.h"

#include <algorithm>
#include <chrono>

namespace supple::jobs {

std::list<ComputeSlots::Computation>::const_iterator ComputeSlots::next() const {
  // Where all slots are taken, there is one for an interactive computation at most.
  const bool is_turn_of_others = turns_.is_turn_of_others() && free(Priority::normal) > 0;
  const auto order = [&](const Computation& one) {
    auto rank = rank_of(one);
    if (is_turn_of_others && rank.urgency == Priority::interactive) rank.urgency = Priority::background;
    return rank;
  };
  return std::ranges::min_element(waiting_, {}, order);
}

void ComputeSlots::acquire(const CancellationToken& token, const Computation& computation) {
  constexpr std::chrono::milliseconds check_interval{20};  // a stop request does not notify the condition variable
  std::unique_lock lock(mutex_);
  const auto own = waiting_.insert(waiting_.end(), computation);
  while (free(rank_of(computation).urgency) <= 0 || next() != own) {
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
  const auto is_other = [](const Computation& one) { return one.priority != Priority::interactive; };
  turns_.begin(computation.client, computation.priority, std::ranges::any_of(waiting_, is_other));
  if (!waiting_.empty() && free(rank_of(*next()).urgency) > 0) wake_.notify_all();
}

void ComputeSlots::release(const Computation& computation, bool is_given_up) {
  const std::lock_guard lock(mutex_);
  --running_;
  if (is_given_up) --given_up_;
  turns_.end(computation.client, computation.priority);
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
