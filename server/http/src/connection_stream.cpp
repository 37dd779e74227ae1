#include "connection_stream.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>

#include "durations.h"

namespace supple::http {
namespace {

using Clock = std::chrono::steady_clock;

bool wait_until_writable(int socket, double seconds) {
  const auto deadline = Clock::now() + duration_of(seconds);
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    pollfd entry{socket, POLLOUT, 0};
    const int ready = ::poll(&entry, 1, static_cast<int>(std::clamp<std::int64_t>(left, 0, 3'600'000)));
    if (ready > 0) return true;
    if (ready == 0 || errno != EINTR) return false;
  }
}

}  // namespace

bool send_now(int socket, std::string_view& text) {
  while (!text.empty()) {
    const auto count = ::send(socket, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count >= 0) {
      text.remove_prefix(static_cast<std::size_t>(count));
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      return true;
    } else if (errno != EINTR) {
      return false;
    }
  }
  return true;
}

bool ConnectionStream::is_writable() const {
  return drops_ || never_waits_ || wait_until_writable(socket_, write_seconds_);
}

ssize_t ConnectionStream::read(char* data, std::size_t size) {
  const auto count = std::min(size, head_.size());
  std::memcpy(data, head_.data(), count);
  head_.remove_prefix(count);
  return static_cast<ssize_t>(count);
}

bool ConnectionStream::send_all(std::string_view text) {
  while (true) {
    if (!send_now(socket_, text)) return false;
    if (text.empty()) return true;
    if (!wait_until_writable(socket_, write_seconds_)) return false;
  }
}

ssize_t ConnectionStream::write(const char* data, std::size_t size) {
  constexpr std::size_t max_buffered_bytes = 64 * 1024;
  if (drops_) return static_cast<ssize_t>(size);
  if (never_waits_ || buffered_.size() + size <= max_buffered_bytes) {
    buffered_.append(data, size);
    return !at_once_ || flush() ? static_cast<ssize_t>(size) : -1;
  }
  return flush() && send_all({data, size}) ? static_cast<ssize_t>(size) : -1;
}

bool ConnectionStream::flush() {
  if (buffered_.empty()) return true;
  std::string_view left = buffered_;
  const bool sent = never_waits_ ? send_now(socket_, left) : send_all(left);
  buffered_.erase(0, never_waits_ ? buffered_.size() - left.size() : std::string::npos);
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
