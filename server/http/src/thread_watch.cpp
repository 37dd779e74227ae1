#include "thread_watch.h"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace supple::http {
namespace {

std::string seconds_text(ThreadWatch::Clock::duration duration) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", std::chrono::duration<double>(duration).count());
  return text;
}

}  // namespace

ThreadWatch::ThreadWatch(std::vector<Watched> threads, Clock::duration max_silence,
                         std::function<void(const std::string&)> warn)
    : max_silence_(max_silence), warn_(std::move(warn)) {
  for (auto& watched : threads) threads_.push_back({std::move(watched)});
  thread_ = std::thread([this] { run(); });
}

ThreadWatch::~ThreadWatch() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void ThreadWatch::run() {
  constexpr int checks_per_max_silence = 10;
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, max_silence_ / checks_per_max_silence, [this] { return ending_; })) {
    for (auto& state : threads_) check(state);
  }
}

void ThreadWatch::check(State& state) const {
  const auto silence = state.watched.silence();
  if (silence >= max_silence_) {
    state.longest = std::max(state.longest, silence);
    if (!std::exchange(state.is_silent, true))
      warn_(state.watched.name + " has been silent for " + seconds_text(silence));
  } else if (std::exchange(state.is_silent, false)) {
    warn_(state.watched.name + " was silent for " + seconds_text(std::exchange(state.longest, {})));
  }
}

}  // namespace supple::http
