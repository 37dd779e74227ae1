#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "supple/problem/problem.h"

namespace supple::http {

/// The client's end of a connection.
class Peer {
 public:
  explicit Peer(int socket) : socket_(socket) {}
  /// Whether the client has closed its end, or only the sending half of it. One poll(2) without waiting, about a
  /// microsecond; any thread, as long as the request is being answered.
  bool hung_up() const;

 private:
  int socket_;
};

/// Answers a request whose handler does not return in time.
class StandIn {
 public:
  virtual ~StandIn() = default;
  /// Sends the problem and closes the connection after it; what the handler returns is dropped then. `is_replaced`: the
  /// handler's place among the requests that are answered, and its thread, are given to others too until it returns.
  /// Any thread, once at most; the handler must not return before this has. Does not wait for the client.
  virtual void answer(const problem::Problem& problem, bool is_replaced) = 0;
};

/// A request that has been read completely.
struct Request {
  std::string method;
  std::string path;  ///< decoded, without the query
  std::map<std::string, std::string> query;
  std::map<std::string, std::string> path_parameters;  ///< "mesh" for a route "/v1/meshes/{mesh}"
  std::string host;  ///< that the client means: the header Host, or an absolute target's
  std::string body;
  Peer peer{-1};
  StandIn* stand_in = nullptr;  ///< of its handler while that runs; null for probes
  std::string id;               ///< 16 hexadecimal digits, the answer's header Supple-Request-Id
  std::string client;           ///< who asks, as shares count it: the address, or "key ID" where a key came along
  std::string key;              ///< the id of the key that came along; empty where none is needed
  /// Whether it may see and delete what any key owns. Without keys everybody may.
  bool sees_all = true;
  int max_waiting_jobs = 0;  ///< of its key; 0: that of the queue alone

  /// The value of a header (names in any case); empty where it is absent. Repeated headers are joined by ", ".
  std::string header(std::string_view name) const;

  std::vector<std::pair<std::string, std::string>> headers;
};

/// Receives the pieces of a streamed answer.
class StreamWriter {
 public:
  virtual ~StreamWriter() = default;
  /// Sends the text at once. False once the client has gone.
  virtual bool write(std::string_view text) = 0;
  virtual bool client_gone() = 0;
};

/// A body that is sent piece by piece, and whose length is known before: it is never in memory as a whole.
struct Pieces {
  std::uint64_t bytes = 0;
  /// Writes `count` bytes from `offset` on. What it throws cuts the answer off and closes the connection, for its head
  /// has been sent: what can be known to be wrong has to be known before.
  std::function<void(std::uint64_t offset, char* to, std::size_t count)> read;
};

struct Response {
  int status = 200;
  std::string content_type;
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers;
  std::string key;  ///< for the log: the id of the key that the handler found to be the request's; mostly empty
  std::optional<Pieces> pieces;  ///< instead of `body`, with a Content-Length
  /// Instead of `body`: writes the answer piece by piece and returns at its end. Runs on the connection's thread.
  std::function<void(StreamWriter&)> stream;

  void set_header(std::string name, std::string value) { headers.emplace_back(std::move(name), std::move(value)); }
};

/// With the letters of ASCII in lower case.
std::string lower_case(std::string_view text);

/// The media type of a header value, lower case, without parameters: "application/json".
std::string media_type(std::string_view header);

/// The first of `offered` that has the highest quality in an Accept header (RFC 9110, 12.5.1); the first of all where
/// the header is empty, nothing where it accepts none.
std::optional<std::string_view> negotiate(std::string_view accept, const std::vector<std::string_view>& offered);

/// What a Prefer header (RFC 7240) asks of a computation.
struct Preference {
  bool respond_async = false;
  std::optional<double> wait;  ///< seconds
};
/// Unknown preferences are ignored. Throws "request.invalid_parameter" for a wait that is no number of seconds in
/// [0, max_wait].
Preference parse_preference(std::string_view header, double max_wait);

}  // namespace supple::http
