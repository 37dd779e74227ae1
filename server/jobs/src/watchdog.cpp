#include "watchdog.h"

#include <utility>
#include <vector>

namespace supple::jobs {

Watchdog::Watchdog(std::function<void()> at_each_check)
    : at_each_check_(std::move(at_each_check)), thread_([this] { run(); }) {}

Watchdog::~Watchdog() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

std::uint64_t Watchdog::add(Watch watch) {
  const std::lock_guard lock(mutex_);
  watches_.emplace(++last_id_, Entry{std::move(watch)});
  if (asleep_) wake_.notify_one();
  return last_id_;
}

void Watchdog::remove(std::uint64_t id) {
  std::unique_lock lock(mutex_);
  reported_.wait(lock, [this, id] { return reporting_ != id; });
  watches_.erase(id);
}

void Watchdog::Entry::check(Clock::time_point now) {
  const auto& token = watch.token;
  if (watch.deadline && now >= *watch.deadline && stopped.reason == StopReason::none) {
    token.request(StopReason::deadline);
    stopped = {StopReason::deadline, *watch.deadline};
  } else if (stopped.reason == StopReason::deadline && !resumed_at && !token.requested()) {
    resumed_at = now;
    if (watch.resumed) watch.resumed(now);
  }
  if (resumed_at && now - *resumed_at >= report_time) token.request(StopReason::deadline);
  if (watch.hung_up && !token.requested() && watch.hung_up()) {
    token.request(StopReason::cancelled);
    stopped = {StopReason::cancelled, now};
    resumed_at.reset();
  }
}

bool Watchdog::Entry::is_overdue(Clock::time_point now) const {
  return stopped.reason != StopReason::none && now - resumed_at.value_or(stopped.since) >= patience;
}

void Watchdog::report_overdue(std::unique_lock<std::mutex>& lock, Clock::time_point now) {
  std::vector<std::uint64_t> late;
  for (auto& [id, entry] : watches_) {
    if (!entry.is_reported && entry.watch.overdue && entry.is_overdue(now)) late.push_back(id);
  }
  for (const auto id : late) {
    const auto found = watches_.find(id);
    if (found == watches_.end()) continue;
    auto& entry = found->second;
    entry.is_reported = true;
    reporting_ = id;
    lock.unlock();
    try {
      entry.watch.overdue(entry.stopped);
    } catch (...) {
      // There is no memory for the report. Whoever waits for the computation goes on waiting.
    }
    lock.lock();
    reporting_ = 0;
    reported_.notify_all();
  }
}

void Watchdog::run() {
  // The thread stays awake for a while after the last watch: computations come in bursts, and waking it takes them a
  // system call.
  constexpr int max_idle_checks = 50;
  int idle_checks = 0;
  std::unique_lock lock(mutex_);
  while (!ending_) {
    idle_checks = watches_.empty() ? idle_checks + 1 : 0;
    if (idle_checks > max_idle_checks) {
      asleep_ = true;
      wake_.wait(lock, [this] { return ending_ || !watches_.empty(); });
      asleep_ = false;
      idle_checks = 0;
    }
    wake_.wait_for(lock, period, [this] { return ending_; });
    if (at_each_check_) {
      lock.unlock();
      try {
        at_each_check_();
      } catch (...) {
        // There is no memory for it. The next check tries again.
      }
      lock.lock();
    }
    const auto now = Clock::now();
    for (auto& [id, entry] : watches_) entry.check(now);
    report_overdue(lock, now);
  }
}

}  // namespace supple::jobs
