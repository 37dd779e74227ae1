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
  constexpr int checks_per_max_silence = 10;
  for (auto& watched : threads) threads_.push_back({std::move(watched)});
  const auto period = std::chrono::duration_cast<std::chrono::milliseconds>(max_silence_) / checks_per_max_silence;
  thread_.emplace(
      "the watch of threads",
      [this, period] {
        for (auto& state : threads_) check(state);
        return period;
      },
      warn_);
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
