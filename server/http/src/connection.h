#pragma once

#include <chrono>
#include <exception>
#include <functional>
#include <optional>
#include <string>

#include "arriving_bodies.h"
#include "chunked_body.h"
#include "input_buffer.h"
#include "request_head.h"
#include "supple/budget/memory.h"
#include "supple/http/router.h"

namespace supple::http {

/// One accepted connection and the request that arrives on it. One thread at a time owns it: the thread of the lobby
/// while it waits, the thread of its request while that is answered. No call blocks.
class Connection {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t max_head_bytes = 64 * 1024;
  /// Bytes that are read from one connection before the thread goes on to others.
  static constexpr std::size_t max_turn_bytes = 512 * 1024;
  /// Time for which `linger` discards input.
  static constexpr std::chrono::seconds linger_time{2};

  /// Called once the head has been read: sets `route`, and all of `request` but the body. The request is refused with
  /// what it throws.
  using Admit = std::function<void(Connection&)>;
  /// Times that a request may take to arrive.
  struct Timeouts {
    Clock::duration idle{};     ///< from one request to the first byte of the next
    Clock::duration head{};     ///< from the first byte to the end of the head
    Clock::duration request{};  ///< from the first byte to the end of the body
  };

  /// Owns the socket. Bodies are reserved from `memory`, unless it is null; `bodies` must outlive this object.
  Connection(int socket, std::string client, budget::MemoryBudget* memory, ArrivingBodies& bodies,
             const Timeouts& timeouts);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  enum class Arrival {
    waiting,   ///< more bytes are needed, until `deadline`
    complete,  ///< the request can be answered
    refused,   ///< the request is to be answered with `refusal`
    closed     ///< the client has closed the connection, or it is broken
  };
  /// Reads what has arrived, but at most `max_bytes`; the rest stays in the socket's buffer until the next call.
  Arrival advance(const Admit& admit, std::size_t max_bytes = max_turn_bytes);
  /// To be called after the deadline. Refuses a request that has begun to arrive; if none has, the result is `closed`.
  Arrival expire();
  /// Sets the error with which the request is answered.
  void refuse(std::exception_ptr reason) { refusal_ = std::move(reason); }
  /// Prepares for the next request.
  void begin_next();
  /// Leaves `rest`, the end of an answer, to `send_more`. No request is read before the client has taken it, for which
  /// it has `timeout`. With `is_last`, no further request is answered.
  void send_later(std::string rest, Clock::duration timeout, bool is_last);
  enum class Sent { waiting, all, failed };
  /// Sends as much as the client takes without waiting.
  Sent send_more();
  /// Whether the answer that is being sent is the last one on this connection.
  bool sends_last() const { return is_last_; }
  /// Ends sending, and lets `discard` take further input: closing a socket with unread input could destroy the answer
  /// on its way.
  void linger();
  /// Keeps the destructor from shutting the connection down: another object with its own descriptor sends the answer.
  void skip_shutdown() { skips_shutdown_ = true; }
  /// Discards what has arrived. Returns false once the client has closed its end.
  bool discard();

  int socket() const { return socket_; }
  const std::string& client() const { return client_; }
  Clock::time_point deadline() const { return deadline_; }
  /// Start of the wait for a request or, after its first byte, for the rest of it.
  Clock::time_point waiting_since() const { return waiting_since_; }
  /// Whether no byte of a request has arrived.
  bool idle() const { return state_ == State::idle; }
  bool lingering() const { return state_ == State::lingering; }
  bool sending() const { return state_ == State::sending; }
  /// Whether bytes of a further request have arrived already.
  bool has_input() const { return !input_.empty(); }

  /// Head of the current request; nothing if it could not be read.
  const std::optional<RequestHead>& head() const { return head_; }
  /// Memory that the body, and later the handler, reserves.
  budget::MemoryBudget::Reservation& memory() { return memory_; }
  /// The error with which the request is answered; null if it is not refused.
  const std::exception_ptr& refusal() const { return refusal_; }
  /// Whether the request may have a body that has not been read: then no later bytes can be understood as a request.
  bool unread() const { return unread_; }

  Request request;               ///< the current request, as handlers see it
  const Route* route = nullptr;  ///< route of the current request; null if none matches
  int answered = 0;              ///< requests so far; the answering thread counts them
  bool surplus = false;          ///< exceeds the limit of connections: may send one probe only

 private:
  enum class State { idle, head, body, arrived, sending, lingering };
  // The following functions throw the error with which the request is refused.
  Arrival read_request_head(const Admit& admit);
  Arrival read_body();
  /// Returns the number of bytes received, within `remaining_turn_bytes_`: 0 if none has arrived, -1 if the connection
  /// has ended.
  long receive(char* data, std::size_t capacity);
  /// Drops the empty lines before a request.
  void skip_empty_lines();
  /// Prepares for the body, once the head has been read and admitted.
  void begin_body();
  /// Reserves and allocates memory for `bytes` of the body.
  void reserve_body(std::size_t bytes);
  /// Moves the bytes that were received with the head to a body of known length.
  void take_from_input(std::size_t length);
  /// Refuses a request that has not arrived completely.
  Arrival refuse_arriving(std::exception_ptr reason);

  const int socket_;
  const std::string client_;
  budget::MemoryBudget* const budget_;
  ArrivingBodies& bodies_;
  const Timeouts timeouts_;
  State state_ = State::idle;
  Clock::time_point waiting_since_ = Clock::now();
  Clock::time_point deadline_{};
  InputBuffer input_;         ///< bytes that have arrived and belong to no request yet
  std::size_t searched_ = 0;  ///< bytes of `input_` in which no head ends
  int empty_lines_ = 0;       ///< empty lines before the request
  std::optional<RequestHead> head_;
  ChunkedBody chunks_;
  budget::MemoryBudget::Reservation memory_;
  std::optional<ArrivingBodies::CountedBytes> arriving_;
  std::size_t remaining_turn_bytes_ = 0;  ///< bytes that `advance` may still read
  std::size_t reserved_ = 0;              ///< bytes that are reserved for the body
  std::string unsent_;                    ///< rest of the answer, for `send_more`
  std::size_t sent_ = 0;                  ///< bytes of `unsent_` that have been sent
  bool is_last_ = false;
  std::exception_ptr refusal_;
  bool unread_ = false;
  bool skips_shutdown_ = false;
};

}  // namespace supple::http
