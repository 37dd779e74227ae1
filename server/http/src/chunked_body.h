#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "input_buffer.h"

namespace supple::http {

/// Parses a body in chunks (RFC 9112, 7.1) as its bytes arrive. It is strict: chunk sizes are hexadecimal digits alone,
/// extensions begin with a semicolon, trailers have the form of headers, and no line contains a control character.
/// Extensions and trailers are limited in length and ignored.
class ChunkedBody {
 public:
  /// Moves the bytes of the body from `input` to the end of `body`. Returns true once the body is complete; what
  /// remains in `input` then belongs to the next request. Throws Error "http.bad_request" if the framing is broken.
  bool take(InputBuffer& input, std::string& body);

 private:
  enum class State { size, data, end_of_data, trailer, done };
  /// Removes the next line from `input`, without its CR LF. Returns false if it has not arrived completely.
  static bool take_line(std::string_view& input, std::string_view& line);

  State state_ = State::size;
  std::uint64_t remaining_ = 0;    ///< bytes of the current chunk that have not arrived
  std::size_t trailer_bytes_ = 0;  ///< bytes of trailers that have been read
};

}  // namespace supple::http
