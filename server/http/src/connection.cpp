#include "connection.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "supple/problem/problem.h"

namespace supple::http {
namespace {

constexpr std::size_t piece = 64 * 1024;         // bytes received at a time
constexpr std::size_t body_piece = 1024 * 1024;  // bytes that a body grows by
constexpr std::size_t kept_input = 4 * 1024;     // of the buffer of a connection that waits
constexpr long most_at_once = 4 * 1024 * 1024;   // bytes read of one connection before others get their turn

[[noreturn]] void throw_too_large(const BodyLimit& limit, double bytes) {
  problem::throw_limit("request.body_too_large", "The body's length in bytes", static_cast<double>(limit.bytes), bytes,
                       limit.setting);
}

}  // namespace

Connection::Connection(int socket, std::string client, budget::MemoryBudget* memory, const Patience& patience)
    : socket_(socket),
      client_(std::move(client)),
      budget_(memory),
      patience_(patience),
      deadline_(Clock::now() + patience.idle) {}

Connection::~Connection() {
  ::shutdown(socket_, SHUT_RDWR);
  ::close(socket_);
}

void Connection::begin_next() {
  place_ = Place::idle;
  waits_since_ = Clock::now();
  deadline_ = waits_since_ + patience_.idle;
  head_.reset();
  chunks_ = {};
  request = Request();
  route = nullptr;
  memory_.release();
  refusal_ = nullptr;
  unread_ = false;
  if (input_.empty() && input_.capacity() > kept_input) input_ = std::string();
}

void Connection::linger(Clock::duration most) {
  begin_next();
  ::shutdown(socket_, SHUT_WR);
  place_ = Place::lingering;
  deadline_ = Clock::now() + most;
}

bool Connection::discard() const {
  std::array<char, piece> buffer;
  const auto count = receive(buffer.data(), buffer.size());
  return count >= 0;
}

long Connection::receive(char* data, std::size_t room) const {
  while (true) {
    const auto count = ::recv(socket_, data, room, MSG_DONTWAIT);
    if (count > 0) return count;
    if (count < 0 && errno == EINTR) continue;
    return count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK) ? 0 : -1;
  }
}

Connection::Arrival Connection::give_up(std::exception_ptr reason) {
  refusal_ = std::move(reason);
  place_ = Place::arrived;
  return Arrival::refused;
}

Connection::Arrival Connection::expire() {
  if (place_ == Place::idle || place_ == Place::lingering) return Arrival::closed;
  unread_ = true;
  return give_up(std::make_exception_ptr(
      Error("http.request_timeout", "The request did not arrive completely in the time that it may take.")));
}

Connection::Arrival Connection::advance(const Admit& admit) {
  if (place_ == Place::idle || place_ == Place::head) {
    const auto arrival = read_request_head(admit);
    if (arrival != Arrival::complete || place_ != Place::body) return arrival;
  }
  return read_body();
}

Connection::Arrival Connection::read_request_head(const Admit& admit) {
  while (true) {
    while (place_ == Place::idle && input_.starts_with("\r\n")) input_.erase(0, 2);  // RFC 9112, 2.2
    if (!input_.empty() && place_ == Place::idle) {
      place_ = Place::head;
      waits_since_ = Clock::now();
      deadline_ = waits_since_ + patience_.head;
    }
    const auto end = end_of_head(input_);
    if (end != std::string::npos && end <= max_head_bytes) {
      try {
        head_ = read_head(std::string_view(input_).substr(0, end));
        input_.erase(0, end);
        unread_ = head_->has_body();
        admit(*this);
        if (!head_->has_body()) {
          place_ = Place::arrived;
          return Arrival::complete;
        }
        memory_ = budget_ ? budget::MemoryBudget::Reservation(*budget_) : budget::MemoryBudget::Reservation();
        const auto& limit = route->body;
        if (limit.bytes == 0) throw Error("http.bad_request", "This request takes no body.");
        const auto length = head_->content_length.value_or(0);
        if (length > limit.bytes) throw_too_large(limit, static_cast<double>(length));
        memory_.add(static_cast<std::int64_t>(length), "the body");
      } catch (...) {
        unread_ = unread_ || !head_;
        return give_up(std::current_exception());
      }
      place_ = Place::body;
      deadline_ = waits_since_ + patience_.request;
      if (head_->expects_continue && input_.empty()) {
        constexpr std::string_view go_on = "HTTP/1.1 100 Continue\r\n\r\n";
        ::send(socket_, go_on.data(), go_on.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      }
      return Arrival::complete;  // of the head
    }
    if (end != std::string::npos || input_.size() > max_head_bytes) {
      unread_ = true;
      return give_up(std::make_exception_ptr(
          Error("http.head_too_large",
                "The request's head has more than " + std::to_string(max_head_bytes) + " bytes, its limit.")));
    }
    std::array<char, piece> buffer;
    const auto count = receive(buffer.data(), buffer.size());
    if (count < 0) {
      if (place_ == Place::idle) return Arrival::closed;
      unread_ = true;
      return give_up(std::make_exception_ptr(Error("http.bad_request", "The request's head ended early.")));
    }
    if (count == 0) return Arrival::waiting;
    input_.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

Connection::Arrival Connection::read_body() {
  try {
    const auto& limit = route->body;
    auto& body = request.body;
    long received = 0;
    while (true) {
      if (head_->chunked) {
        if (const auto most = body.size() + input_.size(); most > body.capacity()) {
          const auto room = std::max(most, 2 * body.capacity());
          memory_.add(static_cast<std::int64_t>(room - body.capacity()), "the body");
          body.reserve(room);
        }
        const bool done = chunks_.take(input_, body);
        if (body.size() > limit.bytes) throw_too_large(limit, static_cast<double>(body.size()));
        if (done) break;
      } else {
        const auto length = static_cast<std::size_t>(*head_->content_length);
        const auto count = std::min(length - body.size(), input_.size());
        body.append(input_, 0, count);
        input_.erase(0, count);
        if (body.size() == length) break;
      }
      if (received > most_at_once) return Arrival::waiting;
      // The buffer grows with what arrives: an announced length alone costs nothing.
      long count = 0;
      if (head_->chunked) {
        std::array<char, piece> buffer;
        count = receive(buffer.data(), buffer.size());
        if (count > 0) input_.append(buffer.data(), static_cast<std::size_t>(count));
      } else {
        const auto have = body.size();
        const auto length = static_cast<std::size_t>(*head_->content_length);
        if (body.capacity() == have) body.reserve(std::min(length, std::max(2 * have, have + body_piece)));
        body.resize(std::min({length, body.capacity(), have + body_piece}));
        count = receive(body.data() + have, body.size() - have);
        body.resize(have + static_cast<std::size_t>(std::max(count, 0L)));
      }
      if (count < 0) throw Error("http.bad_request", "The body ended early.");
      if (count == 0) return Arrival::waiting;
      received += count;
    }
  } catch (...) {
    return give_up(std::current_exception());
  }
  unread_ = false;
  place_ = Place::arrived;
  return Arrival::complete;
}

}  // namespace supple::http
