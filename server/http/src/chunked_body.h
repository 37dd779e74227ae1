#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "input_buffer.h"

namespace supple::http {

/// Reads a body in chunks (RFC 9112, 7.1) as its bytes arrive, strictly: sizes are hexadecimal digits alone, extensions
/// begin with a semicolon, trailers are headers, and no line has a control character. Extensions and trailers are
/// bounded and ignored.
class ChunkedBody {
 public:
  /// Moves what belongs to the body from `input` to the end of `body`. True once the body is complete; what is left in
  /// `input` then belongs to the next request. Throws Error "http.bad_request" where the framing is broken.
  bool take(InputBuffer& input, std::string& body);

 private:
  enum class Place { size, data, end_of_data, trailer, done };
  /// Takes the next line, without its end, from `input`. False while it has not arrived.
  static bool take_line(std::string_view& input, std::string_view& line);

  Place place_ = Place::size;
  std::uint64_t left_ = 0;         ///< bytes of the chunk that have not arrived yet
  std::size_t trailer_bytes_ = 0;  ///< read so far
};

}  // namespace supple::http
