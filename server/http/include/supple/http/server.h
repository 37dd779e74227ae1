#pragma once

#include <functional>
#include <memory>
#include <string>

#include "supple/http/router.h"

namespace supple::http {

struct ServerOptions {
  std::string host = "127.0.0.1";
  int port = 8080;              ///< 0: any free one
  int max_connections = 256;    ///< served at the same time, one thread each; one more gets a 503
  double idle_seconds = 75;     ///< a kept connection without a request is closed after this
  double request_seconds = 60;  ///< a request that takes longer to arrive is dropped
  double write_seconds = 60;    ///< a client that takes nothing of its answer for this long is dropped
  int requests_per_connection = 1'000'000;
};

/// An HTTP/1.1 server over a Router. Every error, also the library's own, leaves as the response that `render` makes of
/// a problem; no exception of a handler gets past it.
class Server {
 public:
  /// Makes the response for a problem (application/problem+json).
  using Render = std::function<Response(const problem::Problem&)>;
  /// Hears of every answered request: pattern of its route ("" where none fits), method, status, seconds.
  using Observe =
      std::function<void(const std::string& pattern, const std::string& method, int status, double seconds)>;
  /// Hears the text of exceptions whose cause a client is not told.
  using Report = std::function<void(const std::string& text)>;

  Server(const ServerOptions& options, Router router, Render render, Observe observe, Report report);
  ~Server();

  /// Takes the port and returns its number. Throws std::runtime_error where it cannot.
  int bind();
  /// Accepts connections until `stop`; returns once every connection is closed.
  void run();
  /// From any thread, any number of times (once more if `run` began at the same moment): no further connection is
  /// accepted, idle ones close at once, busy ones after the request that they are answering.
  void stop();
  bool stopping() const;
  int connections() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace supple::http
