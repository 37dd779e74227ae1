#include "socket_deadline.h"

#include <sys/socket.h>

namespace supple::store {

SocketDeadline::SocketDeadline(double limit)
    : limit_(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(limit))),
      thread_([this] { run(); }) {}

SocketDeadline::~SocketDeadline() {
  {
    const std::lock_guard lock(mutex_);
    stops_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

SocketDeadline::Watch SocketDeadline::watch(int socket) {
  const std::lock_guard lock(mutex_);
  socket_ = socket;
  until_ = Clock::now() + limit_;
  // Otherwise its thread wakes at the end of an earlier watch, which is before the end of this one.
  if (asleep_) changed_.notify_one();
  return Watch(*this);
}

void SocketDeadline::end() {
  const std::lock_guard lock(mutex_);
  until_.reset();
}

void SocketDeadline::run() {
  std::unique_lock lock(mutex_);
  while (!stops_) {
    if (!until_) {
      asleep_ = true;
      changed_.wait(lock);
      asleep_ = false;
    } else if (const auto until = *until_; Clock::now() < until) {
      changed_.wait_until(lock, until);
    } else {
      ::shutdown(socket_, SHUT_RDWR);
      until_.reset();
    }
  }
}

}  // namespace supple::store
