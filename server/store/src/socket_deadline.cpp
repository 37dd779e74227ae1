#include "socket_deadline.h"

#include <sys/socket.h>

namespace supple::store {

SocketDeadline::SocketDeadline(double limit)
    : limit_(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(limit))),
      thread_([this] { run(); }) {}

SocketDeadline::~SocketDeadline() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

SocketDeadline::Watch SocketDeadline::watch(int socket) {
  const std::lock_guard lock(mutex_);
  socket_ = socket;
  expires_at_ = Clock::now() + limit_;
  // If the thread waits for the end of an earlier watch, it wakes before the end of this one anyway.
  if (waits_for_watch_) changed_.notify_one();
  return Watch(*this);
}

void SocketDeadline::end() {
  const std::lock_guard lock(mutex_);
  expires_at_.reset();
}

void SocketDeadline::run() {
  std::unique_lock lock(mutex_);
  while (!ending_) {
    if (!expires_at_) {
      waits_for_watch_ = true;
      changed_.wait(lock);
      waits_for_watch_ = false;
    } else if (const auto expires_at = *expires_at_; Clock::now() < expires_at) {
      changed_.wait_until(lock, expires_at);
    } else {
      ::shutdown(socket_, SHUT_RDWR);
      expires_at_.reset();
    }
  }
}

}  // namespace supple::store
