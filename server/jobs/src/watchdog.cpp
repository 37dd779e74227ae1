#include "supple/jobs/watchdog.h"

#include <vector>

namespace supple::jobs {

Watchdog::Watchdog(std::function<void()> look) : look_(std::move(look)), thread_([this] { run(); }) {}

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
  watches_.emplace(++next_id_, Entry{std::move(watch)});
  if (asleep_) wake_.notify_one();
  return next_id_;
}

void Watchdog::remove(std::uint64_t id) {
  std::unique_lock lock(mutex_);
  told_.wait(lock, [this, id] { return telling_ != id; });
  watches_.erase(id);
}

void Watchdog::look_at(Entry& entry, Clock::time_point now) {
  const auto& [token, deadline, hung_up, overdue] = entry.watch;
  if (deadline && now >= *deadline) {
    token.request(StopReason::deadline);
    if (entry.stopped.reason == StopReason::none) entry.stopped = {StopReason::deadline, *deadline};
  }
  if (hung_up && !token.requested() && hung_up()) {
    token.request(StopReason::cancelled);
    entry.stopped = {StopReason::cancelled, now};
  }
}

void Watchdog::tell_overdue(std::unique_lock<std::mutex>& lock, Clock::time_point now) {
  std::vector<std::uint64_t> late;
  for (auto& [id, entry] : watches_) {
    if (entry.told || !entry.watch.overdue || entry.stopped.reason == StopReason::none) continue;
    if (now - entry.stopped.since >= patience) late.push_back(id);
  }
  for (const auto id : late) {
    const auto found = watches_.find(id);
    if (found == watches_.end()) continue;
    auto& entry = found->second;
    entry.told = true;
    telling_ = id;
    lock.unlock();
    try {
      entry.watch.overdue(entry.stopped);
    } catch (...) {
      // There is no memory for it: whoever waits goes on waiting.
    }
    lock.lock();
    telling_ = 0;
    told_.notify_all();
  }
}

void Watchdog::run() {
  // Stays awake for a while after the last watch: computations come in bursts, and waking costs them a system call.
  constexpr int idle_rounds_before_sleep = 50;
  int idle_rounds = 0;
  std::unique_lock lock(mutex_);
  while (!ending_) {
    idle_rounds = watches_.empty() ? idle_rounds + 1 : 0;
    if (idle_rounds > idle_rounds_before_sleep) {
      asleep_ = true;
      wake_.wait(lock, [this] { return ending_ || !watches_.empty(); });
      asleep_ = false;
      idle_rounds = 0;
    }
    wake_.wait_for(lock, period, [this] { return ending_; });
    if (look_) {
      lock.unlock();
      look_();
      lock.lock();
    }
    const auto now = Clock::now();
    for (auto& [id, entry] : watches_) look_at(entry, now);
    tell_overdue(lock, now);
  }
}

}  // namespace supple::jobs
