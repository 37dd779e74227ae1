#include "compute_slots.h"

#include <algorithm>
#include <chrono>
#include <tuple>

namespace supple::jobs {

int ComputeSlots::running_of(const std::string& client, bool is_interactive) const {
  const auto found = running_of_client_.find({client, is_interactive});
  return found == running_of_client_.end() ? 0 : found->second;
}

Priority ComputeSlots::rank_of(const Computation& computation) const {
  const bool goes_first = computation.is_interactive() && turns_.goes_first(running_of(computation.client, true));
  return goes_first ? Priority::interactive : std::max(computation.priority, Priority::normal);
}

std::list<ComputeSlots::Computation>::const_iterator ComputeSlots::next() const {
  // Where all slots are taken, there is one for an interactive computation at most.
  const bool is_turn_of_others = turns_.is_turn_of_others() && free(Priority::normal) > 0;
  const auto order = [&](const Computation& one) {
    const auto rank = rank_of(one);
    return std::tuple(is_turn_of_others && rank == Priority::interactive ? Priority::background : rank,
                      running_of(one.client, true) + running_of(one.client, false), one.priority);
  };
  return std::min_element(waiting_.begin(), waiting_.end(),
                          [&](const Computation& a, const Computation& b) { return order(a) < order(b); });
}

void ComputeSlots::acquire(const CancellationToken& token, const Computation& computation) {
  constexpr std::chrono::milliseconds check_interval{20};  // a stop request does not notify the condition variable
  std::unique_lock lock(mutex_);
  const auto own = waiting_.insert(waiting_.end(), computation);
  while (free(rank_of(computation)) <= 0 || next() != own) {
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
  ++running_of_client_[{computation.client, computation.is_interactive()}];
  turns_.note_start(computation.is_interactive(), std::any_of(waiting_.begin(), waiting_.end(),
                                                              [](const auto& one) { return !one.is_interactive(); }));
  if (!waiting_.empty() && free(rank_of(*next())) > 0) wake_.notify_all();
}

void ComputeSlots::release(const Computation& computation, bool is_given_up) {
  const std::lock_guard lock(mutex_);
  --running_;
  if (is_given_up) --given_up_;
  const auto count = running_of_client_.find({computation.client, computation.is_interactive()});
  if (--count->second == 0) running_of_client_.erase(count);
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
