#include "connection_threads.h"

#include <system_error>

namespace supple::http {

void ConnectionThreads::enqueue(std::function<void()> serve) {
  const std::lock_guard lock(mutex_);
  waiting_.push_back(std::move(serve));
  grow();
  wake_.notify_one();
}

void ConnectionThreads::grow() {
  if (!ending_ && idle_ < waiting_.size() && threads_.size() < max_threads_) {
    try {
      threads_.emplace_back([this] { work(); });
    } catch (const std::system_error&) {
      // The system allows no further thread. The task waits for one of the existing threads.
      if (threads_.empty()) throw;
    }
  }
}

void ConnectionThreads::raise_limit() {
  const std::lock_guard lock(mutex_);
  ++max_threads_;
  grow();
}

void ConnectionThreads::lower_limit() {
  const std::lock_guard lock(mutex_);
  --max_threads_;
}

bool ConnectionThreads::has_waiting() const {
  const std::lock_guard lock(mutex_);
  return !waiting_.empty();
}

void ConnectionThreads::finish() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  wake_.notify_all();
  for (auto& thread : threads_) thread.join();
  threads_.clear();
}

void ConnectionThreads::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    ++idle_;
    wake_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
    --idle_;
    if (waiting_.empty()) return;
    const auto serve = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    serve();
    lock.lock();
  }
}

}  // namespace supple::http
