#include "supple/jobs/watchdog.h"

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
  watches_.emplace(++next_id_, std::move(watch));
  if (asleep_) wake_.notify_one();
  return next_id_;
}

void Watchdog::remove(std::uint64_t id) {
  const std::lock_guard lock(mutex_);
  watches_.erase(id);
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
    for (const auto& [id, watch] : watches_) {
      if (watch.deadline && now >= *watch.deadline) watch.token.request(StopReason::deadline);
      if (watch.hung_up && !watch.token.requested() && watch.hung_up()) watch.token.request(StopReason::cancelled);
    }
  }
}

}  // namespace supple::jobs
