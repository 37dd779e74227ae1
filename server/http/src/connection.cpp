#include "connection.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "connection_stream.h"
#include "supple/problem/problem.h"

namespace supple::http {
namespace {

constexpr std::size_t piece = 64 * 1024;        // bytes received at a time
constexpr std::size_t body_piece = 256 * 1024;  // bytes of a body received at a time
constexpr std::size_t kept_input = 4 * 1024;    // of the buffer of a connection that waits
constexpr int max_empty_lines = 8;              // before a request: RFC 9112, 2.2 asks to ignore one

[[noreturn]] void throw_too_large(const BodyLimit& limit, double bytes) {
  problem::throw_limit("request.body_too_large", "The body's length in bytes", static_cast<double>(limit.bytes), bytes,
                       limit.setting);
}

/// The size of a buffer for so many bytes of a body of this length. It grows with what arrives: an announced length
/// alone costs nothing. Sizes are halves of the length, so that doubling them ends there.
std::size_t room_of(std::size_t length, std::size_t needed) {
  std::size_t room = length;
  while (room > ArrivingBodies::small && (room + 1) / 2 >= needed) room = (room + 1) / 2;
  return room;
}

}  // namespace

Connection::Connection(int socket, std::string client, budget::MemoryBudget* memory, ArrivingBodies& bodies,
                       const Patience& patience)
    : socket_(socket),
      client_(std::move(client)),
      budget_(memory),
      bodies_(bodies),
      patience_(patience),
      deadline_(Clock::now() + patience.idle) {}

Connection::~Connection() {
  if (!is_anothers_) ::shutdown(socket_, SHUT_RDWR);
  ::close(socket_);
}

void Connection::begin_next() {
  place_ = Place::idle;
  waits_since_ = Clock::now();
  deadline_ = waits_since_ + patience_.idle;
  searched_ = 0;
  empty_lines_ = 0;
  head_.reset();
  chunks_ = {};
  request = Request();
  route = nullptr;
  memory_.release();
  arriving_.reset();
  reserved_ = 0;
  refusal_ = nullptr;
  unread_ = false;
  input_.give_back(kept_input);
}

void Connection::send_later(std::string rest, Clock::duration most, bool is_last) {
  begin_next();
  unsent_ = std::move(rest);
  sent_ = 0;
  is_last_ = is_last;
  place_ = Place::sending;
  deadline_ = Clock::now() + most;
}

Connection::Sent Connection::send_more() {
  std::string_view left = std::string_view(unsent_).substr(sent_);
  if (!send_now(socket_, left)) return Sent::failed;
  sent_ = unsent_.size() - left.size();
  if (!left.empty()) return Sent::waiting;
  unsent_ = std::string();
  return Sent::all;
}

void Connection::linger() {
  begin_next();
  ::shutdown(socket_, SHUT_WR);
  place_ = Place::lingering;
  deadline_ = Clock::now() + linger_time;
}

bool Connection::discard() {
  std::array<char, piece> buffer;
  left_of_turn_ = piece;
  return receive(buffer.data(), buffer.size()) >= 0;
}

long Connection::receive(char* data, std::size_t room) {
  while (true) {
    const auto count = ::recv(socket_, data, std::min(room, left_of_turn_), MSG_DONTWAIT);
    if (count > 0) {
      left_of_turn_ -= static_cast<std::size_t>(count);
      return count;
    }
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
  if (place_ == Place::idle || place_ == Place::sending || place_ == Place::lingering) return Arrival::closed;
  unread_ = true;
  return give_up(std::make_exception_ptr(
      Error("http.request_timeout", "The request did not arrive completely in the time that it may take.")));
}

Connection::Arrival Connection::advance(const Admit& admit, std::size_t max_bytes) {
  left_of_turn_ = max_bytes;
  if (place_ == Place::idle || place_ == Place::head) {
    const auto arrival = read_request_head(admit);
    if (arrival != Arrival::complete || place_ != Place::body) return arrival;
  }
  return read_body();
}

bool Connection::skip_empty_lines() {
  while (place_ == Place::idle && input_.view().starts_with("\r\n")) {
    if (++empty_lines_ > max_empty_lines) return false;
    input_.drop(2);
  }
  return true;
}

Connection::Arrival Connection::read_request_head(const Admit& admit) {
  const auto refuse = [&](const std::string& code, const std::string& why) {
    unread_ = true;
    return give_up(std::make_exception_ptr(Error(code, why)));
  };
  while (true) {
    if (!skip_empty_lines()) return refuse("http.bad_request", "There are too many empty lines before the request.");
    if (!input_.empty() && place_ == Place::idle) {
      place_ = Place::head;
      waits_since_ = Clock::now();
      deadline_ = waits_since_ + patience_.head;
    }
    const auto end = end_of_head(input_.view(), searched_);
    if (end != std::string::npos && end <= max_head_bytes) {
      try {
        head_ = read_head(input_.view().substr(0, end));
        input_.drop(end);
        unread_ = head_->has_body();
        admit(*this);
        if (!head_->has_body()) {
          place_ = Place::arrived;
          return Arrival::complete;
        }
        memory_ = budget_ ? budget::MemoryBudget::Reservation(*budget_) : budget::MemoryBudget::Reservation();
        arriving_.emplace(bodies_, client_);
        const auto& limit = route->body;
        if (limit.bytes == 0) throw Error("http.bad_request", "This request takes no body.");
        const auto length = head_->content_length.value_or(0);
        if (length > limit.bytes) throw_too_large(limit, static_cast<double>(length));
        if (budget_) budget_->check_one(static_cast<std::int64_t>(length), "the body");
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
    if (end != std::string::npos || input_.size() > max_head_bytes)
      return refuse("http.head_too_large",
                    "The request's head has more than " + std::to_string(max_head_bytes) + " bytes, its limit.");
    searched_ = input_.size();
    if (left_of_turn_ == 0) return Arrival::waiting;
    std::array<char, piece> buffer;
    const auto count = receive(buffer.data(), buffer.size());
    if (count < 0) {
      if (place_ == Place::idle) return Arrival::closed;
      return refuse("http.bad_request", "The request's head ended early.");
    }
    if (count == 0) return Arrival::waiting;
    input_.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

void Connection::make_room(std::size_t bytes) {
  auto& body = request.body;
  if (bytes <= body.capacity()) return;
  // What strings grow by at least.
  const auto room = std::max(bytes, 2 * body.capacity());
  const auto counted = room - std::min(room, ArrivingBodies::small);
  if (counted > reserved_) {
    const auto more = static_cast<std::int64_t>(counted - reserved_);
    arriving_->add(more);
    memory_.add(more, "the body");
    reserved_ = counted;
  }
  body.reserve(room);
}

void Connection::take_from_input(std::size_t length) {
  const auto count = std::min(length - request.body.size(), input_.size());
  if (count == 0) return;
  make_room(room_of(length, request.body.size() + count));
  request.body.append(input_.view().substr(0, count));
  input_.drop(count);
}

Connection::Arrival Connection::read_body() {
  try {
    const auto& limit = route->body;
    auto& body = request.body;
    while (true) {
      long count = 0;
      if (head_->chunked) {
        make_room(body.size() + input_.size());
        const bool done = chunks_.take(input_, body);
        if (body.size() > limit.bytes) throw_too_large(limit, static_cast<double>(body.size()));
        if (done) break;
        if (left_of_turn_ == 0) return Arrival::waiting;
        std::array<char, piece> buffer;
        count = receive(buffer.data(), buffer.size());
        if (count > 0) input_.append(buffer.data(), static_cast<std::size_t>(count));
      } else {
        const auto length = static_cast<std::size_t>(*head_->content_length);
        take_from_input(length);
        const auto have = body.size();
        if (have == length) break;
        if (left_of_turn_ == 0) return Arrival::waiting;
        make_room(room_of(length, have + 1));
        body.resize(std::min({length, body.capacity(), have + std::min(body_piece, left_of_turn_)}));
        count = receive(body.data() + have, body.size() - have);
        body.resize(have + static_cast<std::size_t>(std::max(count, 0L)));
      }
      if (count < 0) throw Error("http.bad_request", "The body ended early.");
      if (count == 0) return Arrival::waiting;
    }
  } catch (...) {
    return give_up(std::current_exception());
  }
  arriving_.reset();
  unread_ = false;
  place_ = Place::arrived;
  return Arrival::complete;
}

}  // namespace supple::http
