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
  if (!ending_ && idle_ < waiting_.size() && threads_.size() < most_) {
    try {
      threads_.emplace_back([this] { work(); });
    } catch (const std::system_error&) {
      // The system gives no further thread: the connection waits for one of those that there are.
      if (threads_.empty()) throw;
    }
  }
}

void ConnectionThreads::lend() {
  const std::lock_guard lock(mutex_);
  ++most_;
  grow();
}

void ConnectionThreads::take_back() {
  const std::lock_guard lock(mutex_);
  --most_;
}

bool ConnectionThreads::in_demand() const {
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
