#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "supple/budget/memory.h"
#include "supple/http/router.h"

namespace supple::http {

struct ServerOptions {
  std::string host = "127.0.0.1";
  int port = 8080;             ///< 0: any free port
  int max_connections = 1024;  ///< connections that are open at the same time; setting --max-connections
  int max_requests = 256;      ///< requests that are answered at the same time, one thread each; setting --max-requests
  double max_client_fraction =
      0.75;                     ///< fraction of the connections and requests that one client may have; --client-share
  double idle_seconds = 75;     ///< an idle persistent connection is closed after this
  double head_seconds = 15;     ///< a request whose head takes longer to arrive is refused
  double request_seconds = 60;  ///< a request that takes longer to arrive is refused
  double write_seconds = 60;    ///< a client that takes nothing of its answer for this long is disconnected
  int requests_per_connection = 1'000'000;
  budget::MemoryBudget* memory = nullptr;  ///< bodies are reserved from it; null: no reservations
  /// Gets a line for the log, on a thread of its own, when the thread that accepts connections or reads requests has
  /// not run for `max_silent_seconds`, and once it runs again. Empty: they are not watched.
  std::function<void(const std::string&)> warn{};
  double max_silent_seconds = 5;                             ///< ten times the silence that is normal
  std::vector<std::pair<std::string, std::string>> headers;  ///< added to every answer that does not set them itself
};

/// Record of a request that has been answered.
struct AnsweredRequest {
  std::string id;       ///< id of the request, 16 hexadecimal digits: the answer's header Supple-Request-Id
  std::string address;  ///< address of the sender
  std::string key;      ///< id of the request's key; empty if none was needed or accepted
  std::string pattern;  ///< pattern of the request's route; empty if no route matches
  std::string method;   ///< empty if the head could not be read
  std::string path;
  std::string location;  ///< the answer's header Location, if the request has made something
  int status = 0;
  double seconds = 0;            ///< from the request's last byte to the answer's last byte
  std::uint64_t body_bytes = 0;  ///< length of the request's body
};

/// How busy a server is.
struct Load {
  int connections = 0;
  int answering = 0;                  ///< requests that are being answered, except probes
  std::uint64_t evicted = 0;          ///< connections that were closed to make room for others
  double reader_silence_seconds = 0;  ///< since the thread that reads requests last woke up
  double accept_silence_seconds = 0;  ///< since the thread that accepts connections last woke up
};

/// An HTTP/1.1 server over a Router. Every error becomes a problem, and `render` makes the response of it. This
/// includes errors of the HTTP library and exceptions of handlers.
///
/// A connection occupies no thread until a whole request has arrived. Probes and refusals are answered by threads of
/// their own, so that they are answered even if all other threads are busy.
class Server {
 public:
  /// Makes the response for a problem (application/problem+json).
  using Render = std::function<Response(const problem::Problem&)>;
  /// Called after every answered request, on the thread that answered it.
  using Observe = std::function<void(const AnsweredRequest&)>;
  /// Called with the text of an unexpected exception, which the client is not told.
  using Report = std::function<void(const std::string& text)>;
  /// Called before a body is read: may set the request's key and client, and throws to refuse it. The route is null if
  /// none matches.
  using Guard = std::function<void(Request& head, const Route* route)>;

  Server(const ServerOptions& options, Router router, Render render, Observe observe, Report report, Guard guard = {});
  ~Server();

  /// Binds the port and returns its number. Throws std::runtime_error if this fails.
  int bind();
  /// Accepts connections until `stop`; returns once every connection is closed.
  void run();
  /// Ends `run`. No further connection is accepted. Connections that wait for a request, or for the rest of one, are
  /// closed at once; the others after the request that is being answered. Any thread may call, any number of times. A
  /// call at the moment when `run` begins may be missed, so repeat it until `run` returns.
  void stop();
  bool stopping() const;
  int connections() const;
  Load load() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace supple::http
