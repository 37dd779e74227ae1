#include "supple/base/repeating_thread.h"

#include <exception>
#include <utility>

namespace supple {

RepeatingThread::RepeatingThread(std::string task, Step step, Log log)
    : task_(std::move(task)), step_(std::move(step)), log_(std::move(log)), thread_([this] { run(); }) {}

RepeatingThread::~RepeatingThread() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void RepeatingThread::run() {
  std::unique_lock lock(mutex_);
  while (!ending_) {
    lock.unlock();
    const auto wait = try_step();
    lock.lock();
    wake_.wait_for(lock, wait, [this] { return ending_; });
  }
}

std::chrono::milliseconds RepeatingThread::try_step() noexcept {
  try {
    const auto wait = step_();
    has_failed_ = false;
    return wait;
  } catch (const std::exception& error) {
    note_failure(error.what());
  } catch (...) {
    note_failure("an exception without a text");
  }
  return wait_after_failure;
}

void RepeatingThread::note_failure(const char* reason) noexcept {
  if (std::exchange(has_failed_, true) || !log_) return;
  try {
    log_(task_ + " has failed, and tries again: " + reason);
  } catch (...) {
    // There may be no memory for the line.
  }
}

}  // namespace supple
