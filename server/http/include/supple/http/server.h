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
  int port = 8080;              ///< 0: any free one
  int max_connections = 1024;   ///< open at the same time; setting --max-connections
  int max_requests = 256;       ///< answered at the same time, a thread each; setting --max-requests
  double client_share = 0.75;   ///< of connections and requests that one client may have; setting --client-share
  double idle_seconds = 75;     ///< a kept connection without a request is closed after this
  double head_seconds = 15;     ///< a request whose head takes longer to arrive is refused
  double request_seconds = 60;  ///< a request that takes longer to arrive is refused
  double write_seconds = 60;    ///< a client that takes nothing of its answer for this long is dropped
  int requests_per_connection = 1'000'000;
  budget::MemoryBudget* memory = nullptr;  ///< what bodies are reserved from; none where null
  /// Hears of the threads that accept connections and read requests where one has not been seen for `silent_seconds`,
  /// and once it is seen again: lines for the log, from a thread of its own. Nobody watches them where it is empty.
  std::function<void(const std::string&)> tell{};
  double silent_seconds = 5;                                 ///< ten times what is normal
  std::vector<std::pair<std::string, std::string>> headers;  ///< of every answer that does not set them itself
};

/// What became of a request.
struct Answered {
  std::string id;       ///< of the request, 16 hexadecimal digits; the answer's header Supple-Request-Id
  std::string address;  ///< of its sender
  std::string key;      ///< the id of its key; empty where none was needed or accepted
  std::string pattern;  ///< of its route; empty where none fits
  std::string method;   ///< empty where the head could not be read
  std::string path;
  std::string location;  ///< of what it made: the answer's header Location; empty where there is none
  int status = 0;
  double seconds = 0;            ///< from its last byte to the answer's last byte
  std::uint64_t body_bytes = 0;  ///< of the request
};

/// How busy a server is.
struct Load {
  int connections = 0;
  int answering = 0;          ///< requests that are answered at the moment, probes aside
  std::uint64_t evicted = 0;  ///< connections that were closed to make room for others
  double silence = 0;         ///< seconds since the thread that reads what arrives looked at it
  double accept_silence = 0;  ///< seconds since the thread that accepts connections looked for them
};

/// An HTTP/1.1 server over a Router. Every error, also the library's own, leaves as the response that `render` makes of
/// a problem; no exception of a handler gets past it.
///
/// Connections wait without a thread until all of a request has arrived. Requests for probes, and refusals, have
/// threads of their own, so that they are answered whatever else goes on.
class Server {
 public:
  /// Makes the response for a problem (application/problem+json).
  using Render = std::function<Response(const problem::Problem&)>;
  /// Hears of every answered request, on the thread that answered it.
  using Observe = std::function<void(const Answered&)>;
  /// Hears the text of exceptions whose cause a client is not told.
  using Report = std::function<void(const std::string& text)>;
  /// Decides whether a request may be answered at all, before its body is read, and may name its client. The route is
  /// null where none fits. Throws what refuses the request.
  using Guard = std::function<void(Request& head, const Route* route)>;

  Server(const ServerOptions& options, Router router, Render render, Observe observe, Report report, Guard guard = {});
  ~Server();

  /// Takes the port and returns its number. Throws std::runtime_error where it cannot.
  int bind();
  /// Accepts connections until `stop`; returns once every connection is closed.
  void run();
  /// From any thread, any number of times (once more if `run` began at the same moment): no further connection is
  /// accepted; those that wait for a request, or for the rest of one, close at once; busy ones after the request that
  /// they are answering.
  void stop();
  bool stopping() const;
  int connections() const;
  Load load() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace supple::http
