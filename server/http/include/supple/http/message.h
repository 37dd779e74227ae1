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
  /// Whether the client has closed its end, or only the sending half of it. Takes about a microsecond (one poll(2)
  /// without waiting). Any thread may call while the request is being answered.
  bool hung_up() const;

 private:
  int socket_;
};

/// Answers a request in place of a handler that does not return in time, and leaves the place of one that waits to
/// others.
class StandIn {
 public:
  virtual ~StandIn() = default;
  /// Sends the problem without waiting for the client, then closes the connection; what the handler returns later is
  /// discarded. With `releases_slot`, the late handler no longer counts towards --max-requests, and one more thread may
  /// run. Any thread may call, once at most. The handler must not return before this call has.
  virtual void answer(const problem::Problem& problem, bool releases_slot) = 0;
  /// The handler does nothing from here on but wait for work in the background: it no longer counts towards
  /// --max-requests, but among as many others that wait so, and one more thread may run. Called by the handler, once at
  /// most, and before anybody calls `answer`. Where there is no place among those either, this throws "server.busy"
  /// (503) or "server.client_share" (429).
  virtual void wait_in_background() = 0;
};

/// A request that has been read completely.
struct Request {
  std::string method;
  std::string path;  ///< percent-decoded, without the query
  std::map<std::string, std::string> query;
  std::map<std::string, std::string> path_parameters;  ///< with the key "mesh" for a route "/v1/meshes/{mesh}"
  std::string host;  ///< name by which the client calls the server: the authority of an absolute target, else Host
  std::string body;
  Peer peer{-1};
  StandIn* stand_in = nullptr;  ///< may answer while the handler runs; null for probes
  std::string id;               ///< 16 hexadecimal digits, sent as the header Supple-Request-Id of the answer
  std::string client;           ///< identity for limits per client: the address, or "key ID" if a key was sent
  std::string key;              ///< id of the key that was sent; empty if none is needed
  /// Whether the request may see and delete what any key owns. Without keys every request may.
  bool is_admin = true;
  int max_waiting_jobs = 0;  ///< limit of the request's key; 0: only the limit of the queue counts

  /// The value of a header (name in any case); empty if it is absent. Repeated headers are joined by ", ".
  std::string header(std::string_view name) const;

  std::vector<std::pair<std::string, std::string>> headers;
};

/// Receives the pieces of a streamed answer.
class StreamWriter {
 public:
  virtual ~StreamWriter() = default;
  /// Sends the text at once. Returns false if the client has gone.
  virtual bool write(std::string_view text) = 0;
  /// Whether the client has closed the connection or a write has failed.
  virtual bool client_gone() = 0;
};

/// A body of known length that is read and sent piece by piece, so that it is never in memory as a whole.
struct PiecewiseBody {
  std::uint64_t bytes = 0;
  /// Writes `count` bytes, from `offset` on. An exception cuts the answer off and closes the connection, because the
  /// head has been sent. The handler therefore checks beforehand what it can.
  std::function<void(std::uint64_t offset, char* to, std::size_t count)> read;
};

struct Response {
  int status = 200;
  std::string content_type;
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers;
  std::string key;  ///< for the log: id of a key that the handler has found, such as at a sign-in; mostly empty
  std::optional<PiecewiseBody> piecewise_body;  ///< sent instead of `body`, with a Content-Length
  /// Used instead of `body`: writes the answer piece by piece, on the thread that answers the request.
  std::function<void(StreamWriter&)> stream;

  void set_header(std::string name, std::string value) { headers.emplace_back(std::move(name), std::move(value)); }
};

/// The text with the ASCII letters in lower case.
std::string lower_case(std::string_view text);

/// The media type of a header's value in lower case, without parameters: "application/json".
std::string media_type(std::string_view header);

/// The offered media type with the highest quality in an Accept header (RFC 9110, 12.5.1); the earlier one wins a tie.
/// An empty header accepts the first type. Returns nothing if the header accepts none.
std::optional<std::string_view> negotiate(std::string_view accept, const std::vector<std::string_view>& offered);

/// The preferences of a Prefer header (RFC 7240) that concern a computation.
struct Preference {
  bool respond_async = false;  ///< answer at once, with a job
  std::optional<double> wait;  ///< seconds to wait for the result before the answer is a job
};
/// Reads a Prefer header. Unknown preferences are ignored. Throws "request.invalid_parameter" if `wait` is not a number
/// of seconds in [0, max_wait].
Preference parse_preference(std::string_view header, double max_wait);

}  // namespace supple::http
