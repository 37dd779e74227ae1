// Feeds arbitrary bytes to the reader of a connection: heads of requests, and chunked bodies.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "chunked_body.h"
#include "request_head.h"
#include "supple/base/error.h"

namespace {

using supple::http::ChunkedBody;
using supple::http::InputBuffer;

/// The decoded body, whether it is complete, and the remaining bytes; all empty if the framing is refused.
struct Outcome {
  std::string body;
  std::string left;
  bool complete = false;
  bool refused = false;
  bool operator==(const Outcome&) const = default;
};

Outcome read_in_pieces(const std::string& bytes, std::size_t piece) {
  Outcome outcome;
  ChunkedBody chunks;
  InputBuffer input;
  try {
    for (std::size_t at = 0; at < bytes.size(); at += piece) {
      input.append(bytes.data() + at, std::min(piece, bytes.size() - at));
      if (!outcome.complete) outcome.complete = chunks.take(input, outcome.body);
    }
    outcome.left = input.view();
  } catch (const supple::Error&) {
    outcome = {};
    outcome.refused = true;
  }
  return outcome;
}

void read_head_of(const std::string& bytes) {
  const auto end = supple::http::end_of_head(bytes);
  if (end == std::string::npos) return;
  try {
    const auto head = supple::http::read_head(bytes.substr(0, end));
    supple::http::read_query(head.query);
    // The end of the body must be unambiguous.
    if (head.chunked && head.content_length) std::abort();
    if (head.path.empty() || head.path.front() != '/') std::abort();
  } catch (const supple::Error&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  read_head_of(bytes);
  // The result must not depend on how the bytes are divided. One of the two may be refused, because of bytes after the
  // end of the body.
  const auto whole = read_in_pieces(bytes, std::max<std::size_t>(bytes.size(), 1));
  const auto pieces = read_in_pieces(bytes, std::size_t{1} + data[0] % 16);
  if (!whole.refused && !pieces.refused && !(whole == pieces)) std::abort();
  return 0;
}
