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
  std::string target;  ///< as it was sent, from the path on
  std::string path;    ///< percent-decoded, without the query
  std::string query;   ///< as it was sent, without the question mark
  int minor_version = 1;
  std::vector<std::pair<std::string, std::string>> headers;  ///< names as they were sent, values without outer blanks
  std::string host;                                          ///< of the header Host, or of an absolute target
  std::optional<std::uint64_t> content_length;
  bool chunked = false;
  bool expects_continue = false;

  /// The value of the first header of this name, in any case; empty where there is none.
  std::string_view header(std::string_view name) const;
  /// Whether the connection ends with the answer: one of its options is `close`, or it is HTTP/1.0 without
  /// `keep-alive`.
  bool asks_to_close() const;
  bool has_body() const { return chunked || content_length.value_or(0) > 0; }
};

/// Where the head in `text` ends, behind its empty line; npos while it has not arrived completely. It is known not to
/// end within the first `searched` bytes.
std::size_t end_of_head(std::string_view text, std::size_t searched = 0);

/// Reads a complete head, strictly: what two readers could understand in two ways is refused, since a proxy in front of
/// this server may be the other reader. Lines end in CR LF and are not folded; names are tokens directly before their
/// colon; no control characters; one Host with HTTP/1.1; at most one Content-Length, of digits alone; of transfer
/// codings `chunked` alone, not together with Content-Length nor with HTTP/1.0.
///
/// Throws Error "http.bad_request", which says what is wrong, or "http.uri_too_long".
RequestHead read_head(std::string_view text);

/// The parameters of a query; of several with one name the first counts.
std::map<std::string, std::string> read_query(std::string_view query);

}  // namespace supple::http
