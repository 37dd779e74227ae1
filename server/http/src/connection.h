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
  /// Time for which `linger` discards what the client still sends.
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
  /// Ends the waiting after the deadline. A request that has begun to arrive is refused; if none has begun, the
  /// connection is to be closed.
  Arrival expire();
  /// Sets the error with which a request that has arrived is to be answered.
  void refuse(std::exception_ptr reason) { refusal_ = std::move(reason); }
  /// Prepares for the next request, once the last one has been answered.
  void begin_next();
  /// Leaves `rest`, the end of an answer, to `send_more`. The client has `timeout` to take it, and no request is read
  /// until then. With `is_last`, no further request is answered.
  void send_later(std::string rest, Clock::duration timeout, bool is_last);
  enum class Sent { waiting, all, failed };
  /// Sends as much as the client takes without waiting.
  Sent send_more();
  /// Whether the answer that is being sent is the last one on this connection.
  bool sends_last() const { return is_last_; }
  /// Closes the sending half after the last answer. What the client still sends is discarded for `linger_time`: closing
  /// a socket with unread input resets the connection, and the client may lose the answer.
  void linger();
  /// The destructor only closes the descriptor and does not shut the connection down: another object, which has a
  /// descriptor of its own, still sends the answer.
  void skip_shutdown() { skips_shutdown_ = true; }
  /// Discards what has arrived. Returns false once the client has closed its end.
  bool discard();

  int socket() const { return socket_; }
  const std::string& client() const { return client_; }
  Clock::time_point deadline() const { return deadline_; }
  /// Time at which the connection began to wait: for a request or, once its first byte is there, for the rest of it.
  Clock::time_point waiting_since() const { return waiting_since_; }
  /// Whether no byte of a request has arrived.
  bool idle() const { return state_ == State::idle; }
  bool lingering() const { return state_ == State::lingering; }
  bool sending() const { return state_ == State::sending; }
  /// Whether bytes of a further request have arrived already.
  bool has_input() const { return !input_.empty(); }

  /// The head of the current request; nothing if it has not arrived or could not be read.
  const std::optional<RequestHead>& head() const { return head_; }
  /// The memory that the body has reserved; the handler adds to it.
  budget::MemoryBudget::Reservation& memory() { return memory_; }
  /// The error with which the request is to be answered; null if it is not refused.
  const std::exception_ptr& refusal() const { return refusal_; }
  /// Whether the request may have a body that has not been read. Later bytes of the connection cannot be told apart
  /// from that body, so that no further request can be read.
  bool unread() const { return unread_; }

  Request request;               ///< the current request, as handlers see it
  const Route* route = nullptr;  ///< route of the current request; null if none matches
  int answered = 0;              ///< number of requests so far, counted by the thread that answers them
  bool surplus = false;          ///< whether it exceeds the limit of connections: then only one probe is answered

 private:
  enum class State { idle, head, body, arrived, sending, lingering };
  Arrival read_request_head(const Admit& admit);
  Arrival read_body();
  /// Receives at most `capacity` and `remaining_turn_bytes_` bytes. Returns their number: 0 if none has arrived, -1 if
  /// the connection has ended.
  long receive(char* data, std::size_t capacity);
  /// Refuses a request that has not arrived completely.
  Arrival refuse_arriving(std::exception_ptr reason);
  /// Drops the empty lines before a request. Returns false if there are too many.
  bool skip_empty_lines();
  /// Lets the body grow to `bytes`: counts and reserves the memory, then allocates it.
  void reserve_body(std::size_t bytes);
  /// Moves those bytes to a body of known length that have been received together with its head.
  void take_from_input(std::size_t length);

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
  int empty_lines_ = 0;       ///< number of empty lines before the request
  std::optional<RequestHead> head_;
  ChunkedBody chunks_;
  budget::MemoryBudget::Reservation memory_;
  std::optional<ArrivingBodies::CountedBytes> arriving_;
  std::size_t remaining_turn_bytes_ = 0;  ///< bytes that `advance` may still read
  std::size_t reserved_ = 0;              ///< bytes that are reserved for the body
  std::string unsent_;                    ///< end of the answer, which is left to `send_more`
  std::size_t sent_ = 0;                  ///< bytes of `unsent_` that have been sent
  bool is_last_ = false;
  std::exception_ptr refusal_;
  bool unread_ = false;
  bool skips_shutdown_ = false;
};

}  // namespace supple::http
