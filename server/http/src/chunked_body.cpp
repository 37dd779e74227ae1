#include "chunked_body.h"

#include <algorithm>
#include <charconv>

#include "supple/base/error.h"
#include "text.h"

namespace supple::http {
namespace {

constexpr std::size_t max_line_bytes = 1024;
constexpr std::size_t max_trailer_bytes = 8192;
constexpr std::size_t max_size_digits = 15;  // hexadecimal digits, so that sizes are below 2^60

[[noreturn]] void refuse() { throw Error("http.bad_request", "The framing of the body's chunks is broken."); }

std::uint64_t chunk_size(std::string_view line) {
  const auto digits = std::min(line.find_first_of("; \t"), line.size());
  std::uint64_t size = 0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + digits, size, 16);
  if (digits == 0 || digits > max_size_digits || error != std::errc() || end != line.data() + digits) refuse();
  const auto extension = trimmed(line.substr(digits));
  if (!extension.empty() && extension.front() != ';') refuse();
  return size;
}

}  // namespace

bool ChunkedBody::take_line(std::string_view& input, std::string_view& line) {
  const auto end = input.substr(0, max_line_bytes + 1).find('\n');
  if (end == std::string_view::npos) {
    if (input.size() > max_line_bytes) refuse();
    return false;
  }
  if (end == 0 || input[end - 1] != '\r') refuse();
  line = input.substr(0, end - 1);
  if (has_control_character(line)) refuse();
  input.remove_prefix(end + 1);
  return true;
}

bool ChunkedBody::take(InputBuffer& input, std::string& body) {
  std::string_view rest = input.view();
  std::string_view line;
  bool needs_input = false;
  while (!needs_input && state_ != State::done) {
    switch (state_) {
      case State::size:
        if ((needs_input = !take_line(rest, line))) break;
        remaining_ = chunk_size(line);
        state_ = remaining_ > 0 ? State::data : State::trailer;
        break;
      case State::data: {
        const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(remaining_, rest.size()));
        body.append(rest.substr(0, count));
        rest.remove_prefix(count);
        remaining_ -= count;
        needs_input = remaining_ > 0;
        if (!needs_input) state_ = State::end_of_data;
        break;
      }
      case State::end_of_data:
        if ((needs_input = !take_line(rest, line))) break;
        if (!line.empty()) refuse();
        state_ = State::size;
        break;
      case State::trailer:
        if ((needs_input = !take_line(rest, line))) break;
        trailer_bytes_ += line.size();
        if (trailer_bytes_ > max_trailer_bytes) refuse();
        if (line.empty()) {
          state_ = State::done;
        } else if (const auto colon = line.find(':');
                   !is_token(line.substr(0, std::min(colon, line.size()))) || colon == std::string_view::npos) {
          refuse();
        }
        break;
      case State::done:
        break;
    }
  }
  input.drop(input.size() - rest.size());
  return state_ == State::done;
}

}  // namespace supple::http
