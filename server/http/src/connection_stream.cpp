#include "connection_stream.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace supple::http {
namespace {

int milliseconds_until(ConnectionStream::Clock::time_point deadline) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - ConnectionStream::Clock::now()).count();
  return static_cast<int>(std::clamp<std::int64_t>(left, 0, 3'600'000));
}

ConnectionStream::Clock::time_point after(double seconds) {
  return ConnectionStream::Clock::now() +
         std::chrono::duration_cast<ConnectionStream::Clock::duration>(std::chrono::duration<double>(seconds));
}

bool wait_for(int socket, short events, ConnectionStream::Clock::time_point deadline) {
  while (true) {
    pollfd entry{socket, events, 0};
    const int ready = ::poll(&entry, 1, milliseconds_until(deadline));
    if (ready > 0) return true;
    if (ready == 0 || errno != EINTR) return false;
  }
}

}  // namespace

void ConnectionStream::begin_request(Clock::time_point deadline) {
  deadline_ = deadline;
  reading_head_ = true;
  head_bytes_ = 0;
  answer_has_begun_ = false;
}

void ConnectionStream::linger(double seconds) {
  ::shutdown(socket_, SHUT_WR);
  const auto deadline = after(seconds);
  while (wait_for(socket_, POLLIN, deadline)) {
    const auto count = ::recv(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT);
    if (count == 0 || (count < 0 && errno != EINTR && errno != EAGAIN)) return;
    if (Clock::now() >= deadline) return;
  }
}

bool ConnectionStream::is_readable() const { return has_buffered_input() || wait_for(socket_, POLLIN, deadline_); }

bool ConnectionStream::is_writable() const { return wait_for(socket_, POLLOUT, after(write_seconds_)); }

ssize_t ConnectionStream::read(char* data, std::size_t size) {
  if (!flush()) return -1;  // "100 Continue", for which the client waits
  answer_has_begun_ = false;
  if (begin_ == end_) {
    // A body goes straight to its reader where the reader's buffer is the larger one.
    const bool direct = !reading_head_ && size >= buffer_.size();
    char* const target = direct ? data : buffer_.data();
    const std::size_t room = direct ? size : buffer_.size();
    ssize_t count = -1;
    do {
      if (!wait_for(socket_, POLLIN, deadline_)) return -1;
      count = ::recv(socket_, target, room, MSG_DONTWAIT);
    } while (count < 0 && (errno == EINTR || errno == EAGAIN));
    if (count <= 0 || direct) return count;
    begin_ = 0;
    end_ = static_cast<std::size_t>(count);
  }
  const std::size_t count = std::min(size, end_ - begin_);
  if (reading_head_ && (head_bytes_ += count) > max_head_bytes) return -1;
  std::memcpy(data, buffer_.data() + begin_, count);
  begin_ += count;
  return static_cast<ssize_t>(count);
}

bool ConnectionStream::send_all(const char* data, std::size_t size) {
  while (size > 0) {
    const auto count = ::send(socket_, data, size, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count >= 0) {
      data += count;
      size -= static_cast<std::size_t>(count);
    } else if ((errno != EAGAIN && errno != EINTR) || !wait_for(socket_, POLLOUT, after(write_seconds_))) {
      return false;
    }
  }
  return true;
}

ssize_t ConnectionStream::write(const char* data, std::size_t size) {
  constexpr std::size_t small = 64 * 1024;
  if (!answer_has_begun_ && size <= small) {
    answer_has_begun_ = true;
    waiting_.assign(data, size);
    return static_cast<ssize_t>(size);
  }
  if (!waiting_.empty() && size <= small) {
    waiting_.append(data, size);
    return flush() ? static_cast<ssize_t>(size) : -1;
  }
  return flush() && send_all(data, size) ? static_cast<ssize_t>(size) : -1;
}

bool ConnectionStream::flush() {
  if (waiting_.empty()) return true;
  const bool sent = send_all(waiting_.data(), waiting_.size());
  waiting_.clear();
  return sent;
}

void ConnectionStream::get_remote_ip_and_port(std::string& ip, int& port) const {
  ip.clear();
  port = 0;
}

void ConnectionStream::get_local_ip_and_port(std::string& ip, int& port) const {
  ip.clear();
  port = 0;
}

}  // namespace supple::http
