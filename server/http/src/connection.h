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

/// One accepted connection and the request that arrives on it. Owned by one thread at a time: the lobby's while it
/// waits, that of a request while it is answered. Reads without waiting.
class Connection {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t max_head_bytes = 64 * 1024;
  /// Bytes that are read of one connection before others get their turn.
  static constexpr std::size_t turn = 512 * 1024;
  /// How long what a client still sends is discarded.
  static constexpr std::chrono::seconds linger_time{2};

  /// Finds the route of a head, fills `request` with all but the body, and decides whether the body may be read. What
  /// it throws refuses the request.
  using Admit = std::function<void(Connection&)>;
  /// How long a request may take to arrive.
  struct Patience {
    Clock::duration idle{};     ///< from one request to the first byte of the next
    Clock::duration head{};     ///< from the first byte to the end of the head
    Clock::duration request{};  ///< from the first byte to the end of the body
  };

  /// `memory` is what bodies are reserved from, or null; `bodies` outlives this.
  Connection(int socket, std::string client, budget::MemoryBudget* memory, ArrivingBodies& bodies,
             const Patience& patience);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  enum class Arrival {
    waiting,   ///< for more bytes, until `deadline`
    complete,  ///< a request that can be answered
    refused,   ///< one that `refusal` answers
    closed     ///< by the client, or broken
  };
  /// Reads what has arrived, so many bytes at most; the others stay where they are until the next call.
  Arrival advance(const Admit& admit, std::size_t max_bytes = turn);
  /// The deadline has passed: refused where the request has begun to arrive, closed otherwise.
  Arrival expire();
  /// Refuses a request that has arrived.
  void refuse(std::exception_ptr reason) { refusal_ = std::move(reason); }
  /// The request has been answered; the next one may come.
  void begin_next();
  /// What is left of an answer is sent as the client takes it, until `deadline`; until then no request is read.
  void send_later(std::string rest, Clock::duration most, bool is_last);
  enum class Sent { waiting, all, failed };
  /// Sends what the client takes now.
  Sent send_more();
  /// Whether nothing is answered after what is being sent.
  bool sends_last() const { return is_last_; }
  /// Nothing further is answered: what the client still sends is read and discarded for a while, so that closing does
  /// not destroy the answer on its way.
  void linger();
  /// The answer is sent, and the connection ended, by another object that has a descriptor of its own.
  void leave_to_another() { is_anothers_ = true; }
  /// Discards what has arrived. False once the client has closed its end.
  bool discard();

  int socket() const { return socket_; }
  const std::string& client() const { return client_; }
  Clock::time_point deadline() const { return deadline_; }
  /// When it began to wait: for a request, or since the first byte of one for the rest.
  Clock::time_point waits_since() const { return waits_since_; }
  /// Whether no byte of a request has arrived.
  bool idle() const { return place_ == Place::idle; }
  bool lingering() const { return place_ == Place::lingering; }
  bool sending() const { return place_ == Place::sending; }
  /// Whether bytes of a further request have arrived already.
  bool has_input() const { return !input_.empty(); }

  /// The head of the request that arrives or has arrived; nothing where it could not be read.
  const std::optional<RequestHead>& head() const { return head_; }
  budget::MemoryBudget::Reservation& memory() { return memory_; }
  const std::exception_ptr& refusal() const { return refusal_; }
  /// Whether its body, if it has one, has not been read: what follows on the connection cannot be told apart from it.
  bool unread() const { return unread_; }

  Request request;               ///< what arrives or has arrived, as handlers see it
  const Route* route = nullptr;  ///< that answers it; null where none does
  int answered = 0;              ///< requests so far, counted by whoever answers them
  bool surplus = false;          ///< beyond the limit of connections: may ask for one probe

 private:
  enum class Place { idle, head, body, arrived, sending, lingering };
  Arrival read_request_head(const Admit& admit);
  Arrival read_body();
  /// Bytes received, no more than are left of this turn; 0 where none has arrived, -1 where none will.
  long receive(char* data, std::size_t room);
  Arrival give_up(std::exception_ptr reason);
  /// Drops the empty lines before a request. False where there are too many.
  bool skip_empty_lines();
  /// Makes room for so many bytes of the body, and reserves them.
  void make_room(std::size_t bytes);
  /// Takes the part of a body of known length that has been read with its head.
  void take_from_input(std::size_t length);

  const int socket_;
  const std::string client_;
  budget::MemoryBudget* const budget_;
  ArrivingBodies& bodies_;
  const Patience patience_;
  Place place_ = Place::idle;
  Clock::time_point waits_since_ = Clock::now();
  Clock::time_point deadline_{};
  InputBuffer input_;         ///< bytes that have arrived and belong to no request yet
  std::size_t searched_ = 0;  ///< of them, that do not end a head
  int empty_lines_ = 0;       ///< before the request
  std::optional<RequestHead> head_;
  ChunkedBody chunks_;
  budget::MemoryBudget::Reservation memory_;
  std::optional<ArrivingBodies::Share> arriving_;
  std::size_t left_of_turn_ = 0;  ///< bytes that may still be read now
  std::size_t reserved_ = 0;      ///< bytes of the body
  std::string unsent_;            ///< of an answer
  std::size_t sent_ = 0;          ///< of them
  bool is_last_ = false;
  std::exception_ptr refusal_;
  bool unread_ = false;
  bool is_anothers_ = false;
};

}  // namespace supple::http
