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

ThreadWatch::ThreadWatch(std::vector<Watched> threads, Clock::duration most,
                         std::function<void(const std::string&)> tell)
    : most_(most), tell_(std::move(tell)) {
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
  constexpr int looks = 10;
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, most_ / looks, [this] { return ending_; })) {
    for (auto& state : threads_) look_at(state);
  }
}

void ThreadWatch::look_at(State& state) const {
  const auto silence = state.watched.silence();
  if (silence >= most_) {
    state.longest = std::max(state.longest, silence);
    if (!std::exchange(state.is_silent, true))
      tell_(state.watched.name + " has been silent for " + seconds_text(silence));
  } else if (std::exchange(state.is_silent, false)) {
    tell_(state.watched.name + " was silent for " + seconds_text(std::exchange(state.longest, {})));
  }
}

}  // namespace supple::http
