#pragma once

#include <string_view>

#include "connection.h"
#include "connection_threads.h"
#include "library_server.h"
#include "lobby.h"
#include "open_connections.h"
#include "request_slots.h"
#include "response_maker.h"
#include "supple/http/server.h"

namespace supple::http {

/// Answers requests, each on the thread that calls.
class Answerer {
 public:
  /// The parts of the server that answers use.
  struct Parts {
    LibraryServer& library;
    OpenConnections& connections;
    RequestSlots& slots;
    ConnectionThreads& threads;  ///< the threads of requests with a slot
    Lobby& lobby;
  };
  /// The options and the parts must outlive the calls of `answer`.
  Answerer(const ServerOptions& options, const Parts& parts, ResponseMaker responses, Server::Observe observe)
      : options_(options), parts_(parts), responses_(std::move(responses)), observe_(std::move(observe)) {}

  /// What happens to the connection after an answer.
  enum class After {
    next,                 ///< its next request is read
    send,                 ///< the thread of `Lobby` sends the rest of the answer
    linger,               ///< it closes after its input has been discarded
    close,                ///< it closes at once
    answered_by_stand_in  ///< another thread has answered through `StandIn`, and closes it
  };
  /// Answers the request of the connection. Its slot, if it has one, is released before the end of a small answer is
  /// sent, so that a client that has the answer finds it free.
  After answer(Connection& connection, bool has_slot) const;

 private:
  class Exchange;
  /// Sends an answer while the thread of a late handler still uses the connection, which then closes.
  void send_last(Connection& connection, std::string_view text) const;

  const ServerOptions& options_;
  const Parts parts_;
  const ResponseMaker responses_;
  const Server::Observe observe_;
};

}  // namespace supple::http
