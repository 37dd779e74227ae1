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

constexpr std::size_t receive_bytes = 64 * 1024;            // bytes that are received at a time
constexpr std::size_t body_receive_bytes = 256 * 1024;      // the same for bodies of known length
constexpr std::size_t max_retained_input_bytes = 4 * 1024;  // bytes of buffer that an idle connection retains
constexpr int max_empty_lines = 8;  // allowed before a request; RFC 9112, 2.2 asks for one at least

[[noreturn]] void throw_too_large(const BodyLimit& limit, double bytes) {
  problem::throw_limit("request.body_too_large", "The body's length in bytes", static_cast<double>(limit.bytes), bytes,
                       limit.setting);
}

/// Bytes of buffer for the first `needed` bytes of a body of this length. The buffer grows with what arrives, so that
/// an announced length alone costs nothing. Sizes are the length halved repeatedly, so that doubling ends at the
/// length.
std::size_t buffer_size(std::size_t length, std::size_t needed) {
  std::size_t capacity = length;
  while (capacity > ArrivingBodies::uncounted_bytes && (capacity + 1) / 2 >= needed) capacity = (capacity + 1) / 2;
  return capacity;
}

}  // namespace

Connection::Connection(int socket, std::string client, budget::MemoryBudget* memory, ArrivingBodies& bodies,
                       const Timeouts& timeouts)
    : socket_(socket),
      client_(std::move(client)),
      budget_(memory),
      bodies_(bodies),
      timeouts_(timeouts),
      deadline_(Clock::now() + timeouts.idle) {}

Connection::~Connection() {
  if (!skips_shutdown_) ::shutdown(socket_, SHUT_RDWR);
  ::close(socket_);
}

void Connection::begin_next() {
  state_ = State::idle;
  waiting_since_ = Clock::now();
  deadline_ = waiting_since_ + timeouts_.idle;
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
  input_.release_memory(max_retained_input_bytes);
}

void Connection::send_later(std::string rest, Clock::duration timeout, bool is_last) {
  begin_next();
  unsent_ = std::move(rest);
  sent_ = 0;
  is_last_ = is_last;
  state_ = State::sending;
  deadline_ = Clock::now() + timeout;
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
  state_ = State::lingering;
  deadline_ = Clock::now() + linger_time;
}

bool Connection::discard() {
  std::array<char, receive_bytes> buffer;
  remaining_turn_bytes_ = receive_bytes;
  return receive(buffer.data(), buffer.size()) >= 0;
}

long Connection::receive(char* data, std::size_t capacity) {
  while (true) {
    const auto count = ::recv(socket_, data, std::min(capacity, remaining_turn_bytes_), MSG_DONTWAIT);
    if (count > 0) {
      remaining_turn_bytes_ -= static_cast<std::size_t>(count);
      return count;
    }
    if (count < 0 && errno == EINTR) continue;
    return count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK) ? 0 : -1;
  }
}

Connection::Arrival Connection::refuse_arriving(std::exception_ptr reason) {
  refusal_ = std::move(reason);
  state_ = State::arrived;
  return Arrival::refused;
}

Connection::Arrival Connection::expire() {
  if (state_ == State::idle || state_ == State::sending || state_ == State::lingering) return Arrival::closed;
  unread_ = true;
  return refuse_arriving(std::make_exception_ptr(
      Error("http.request_timeout", "The request did not arrive completely in the time that it may take.")));
}

Connection::Arrival Connection::advance(const Admit& admit, std::size_t max_bytes) {
  remaining_turn_bytes_ = max_bytes;
  try {
    if (state_ == State::idle || state_ == State::head) {
      const auto arrival = read_request_head(admit);
      if (arrival != Arrival::complete || state_ != State::body) return arrival;
    }
    return read_body();
  } catch (...) {
    unread_ = unread_ || !head_;
    return refuse_arriving(std::current_exception());
  }
}

void Connection::skip_empty_lines() {
  while (state_ == State::idle && input_.view().starts_with("\r\n")) {
    if (++empty_lines_ > max_empty_lines)
      throw Error("http.bad_request", "There are too many empty lines before the request.");
    input_.drop(2);
  }
}

void Connection::begin_body() {
  memory_ = budget_ ? budget::MemoryBudget::Reservation(*budget_) : budget::MemoryBudget::Reservation();
  arriving_.emplace(bodies_, client_);
  const auto& limit = route->body;
  if (limit.bytes == 0) throw Error("http.bad_request", "This request takes no body.");
  const auto length = head_->content_length.value_or(0);
  if (length > limit.bytes) throw_too_large(limit, static_cast<double>(length));
  if (budget_) budget_->check_one(static_cast<std::int64_t>(length), "the body");
  state_ = State::body;
  deadline_ = waiting_since_ + timeouts_.request;
  if (head_->expects_continue && input_.empty()) {
    constexpr std::string_view continue_line = "HTTP/1.1 100 Continue\r\n\r\n";
    ::send(socket_, continue_line.data(), continue_line.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  }
}

Connection::Arrival Connection::read_request_head(const Admit& admit) {
  while (true) {
    skip_empty_lines();
    if (!input_.empty() && state_ == State::idle) {
      state_ = State::head;
      waiting_since_ = Clock::now();
      deadline_ = waiting_since_ + timeouts_.head;
    }
    const auto end = end_of_head(input_.view(), searched_);
    if (end != std::string::npos && end <= max_head_bytes) {
      head_ = read_head(input_.view().substr(0, end));
      input_.drop(end);
      unread_ = head_->has_body();
      admit(*this);
      if (head_->has_body()) {
        begin_body();
      } else {
        state_ = State::arrived;
      }
      return Arrival::complete;  // with a body, only the head is complete; `advance` goes on with the body
    }
    if (end != std::string::npos || input_.size() > max_head_bytes)
      throw Error("http.head_too_large",
                  "The request's head has more than " + std::to_string(max_head_bytes) + " bytes, its limit.");
    searched_ = input_.size();
    if (remaining_turn_bytes_ == 0) return Arrival::waiting;
    std::array<char, receive_bytes> buffer;
    const auto count = receive(buffer.data(), buffer.size());
    if (count < 0) {
      if (state_ == State::idle) return Arrival::closed;
      throw Error("http.bad_request", "The request's head ended early.");
    }
    if (count == 0) return Arrival::waiting;
    input_.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

void Connection::reserve_body(std::size_t bytes) {
  auto& body = request.body;
  if (bytes <= body.capacity()) return;
  // A string at least doubles its capacity when it grows.
  const auto capacity = std::max(bytes, 2 * body.capacity());
  const auto counted = capacity - std::min(capacity, ArrivingBodies::uncounted_bytes);
  if (counted > reserved_) {
    const auto more = static_cast<std::int64_t>(counted - reserved_);
    arriving_->add(more);
    memory_.add(more, "the body");
    reserved_ = counted;
  }
  body.reserve(capacity);
}

void Connection::take_from_input(std::size_t length) {
  const auto count = std::min(length - request.body.size(), input_.size());
  if (count == 0) return;
  reserve_body(buffer_size(length, request.body.size() + count));
  request.body.append(input_.view().substr(0, count));
  input_.drop(count);
}

Connection::Arrival Connection::read_body() {
  const auto& limit = route->body;
  auto& body = request.body;
  while (true) {
    long count = 0;
    if (head_->chunked) {
      reserve_body(body.size() + input_.size());
      const bool done = chunks_.take(input_, body);
      if (body.size() > limit.bytes) throw_too_large(limit, static_cast<double>(body.size()));
      if (done) break;
      if (remaining_turn_bytes_ == 0) return Arrival::waiting;
      std::array<char, receive_bytes> buffer;
      count = receive(buffer.data(), buffer.size());
      if (count > 0) input_.append(buffer.data(), static_cast<std::size_t>(count));
    } else {
      const auto length = static_cast<std::size_t>(*head_->content_length);
      take_from_input(length);
      const auto received = body.size();
      if (received == length) break;
      if (remaining_turn_bytes_ == 0) return Arrival::waiting;
      reserve_body(buffer_size(length, received + 1));
      body.resize(std::min({length, body.capacity(), received + std::min(body_receive_bytes, remaining_turn_bytes_)}));
      count = receive(body.data() + received, body.size() - received);
      body.resize(received + static_cast<std::size_t>(std::max(count, 0L)));
    }
    if (count < 0) throw Error("http.bad_request", "The body ended early.");
    if (count == 0) return Arrival::waiting;
  }
  arriving_.reset();
  unread_ = false;
  state_ = State::arrived;
  return Arrival::complete;
}

}  // namespace supple::http
