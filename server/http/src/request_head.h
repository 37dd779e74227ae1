#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace supple::http {

/// The head of a request (RFC 9112): its first line and its headers.
struct RequestHead {
  std::string method;
  std::string target;  ///< path and query as they were sent, without the scheme and host of an absolute target
  std::string path;    ///< percent-decoded, without the query
  std::string query;   ///< as it was sent, without the question mark
  int minor_version = 1;
  std::vector<std::pair<std::string, std::string>> headers;  ///< names as sent, values without outer blanks
  std::string host;                                          ///< authority of an absolute target, else the header Host
  std::optional<std::uint64_t> content_length;
  bool chunked = false;
  bool expects_continue = false;

  /// The value of the first header with this name (in any case); empty if there is none.
  std::string_view header(std::string_view name) const;
  /// Whether the client asks to close the connection after the answer: the header Connection contains `close`, or the
  /// version is HTTP/1.0 and it does not contain `keep-alive`.
  bool asks_to_close() const;
  bool has_body() const { return chunked || content_length.value_or(0) > 0; }
};

/// Position in `text` after the empty line that ends the head; npos while the head is incomplete. No head ends within
/// the first `searched` bytes.
std::size_t end_of_head(std::string_view text, std::size_t searched = 0);

/// Parses a complete head. It is strict: a head that a proxy in front of this server could understand differently is
/// refused. The rules are:
/// - Lines end in CR LF, are not folded, and contain no control characters.
/// - The name of a header is a token, and the colon follows it directly.
/// - There is at most one Host, and exactly one in HTTP/1.1.
/// - There is at most one Content-Length, and its value consists of digits.
/// - The only transfer coding is `chunked`, which is refused together with Content-Length and in HTTP/1.0.
///
/// Throws Error "http.bad_request", which says what is wrong, or "http.uri_too_long".
RequestHead read_head(std::string_view text);

/// The percent-decoded parameters of a query. If a name occurs several times, its first value counts.
std::map<std::string, std::string> read_query(std::string_view query);

}  // namespace supple::http
