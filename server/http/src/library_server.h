#pragma once

#include <httplib.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <string>

#include "connection_stream.h"
#include "supple/http/server.h"

namespace supple::http {

/// What this server uses of the library's: the thread that accepts connections, and the writing of answers.
class LibraryServer final : private httplib::Server {
 public:
  using Clock = std::chrono::steady_clock;
  using Fill = std::function<void(httplib::Response&)>;

  /// `accept` gets each accepted socket, which it owns, on the accepting thread.
  LibraryServer(const ServerOptions& options, std::function<void(int socket)> accept);

  /// Binds the port, listens on it, and returns its number. Throws std::runtime_error if this fails.
  int take_port();
  /// Accepts connections until `end`.
  void accept_connections();
  /// Ends `accept_connections`. Any thread may call, any number of times.
  void end();
  /// Whether `end` was called.
  bool ending() const { return ending_; }
  /// Time since the accepting thread last woke up: normally half a second at most.
  Clock::duration silence() const { return Clock::now().time_since_epoch() - last_accept_.load(); }
  /// Writes the answer that `fill` makes to the request whose head `stream` contains. `is_last` announces that the
  /// connection closes; `closed_by_client` is set if the client asks for it. Returns false if not all could be written.
  bool answer(ConnectionStream& stream, bool is_last, bool& closed_by_client, const Fill& fill);

 private:
  bool process_and_close_socket(socket_t socket) override;

  const std::string host_;
  const int port_;
  const std::function<void(int socket)> accept_;
  std::atomic<Clock::duration> last_accept_{Clock::now().time_since_epoch()};
  std::atomic<bool> ending_{false};
  std::atomic<bool> ended_{false};  ///< whether the library's stop was called, which is allowed once
};

}  // namespace supple::http
