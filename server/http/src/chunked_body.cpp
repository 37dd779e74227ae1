#include "chunked_body.h"

#include <algorithm>
#include <charconv>

#include "supple/base/error.h"

namespace supple::http {
namespace {

constexpr std::size_t max_line_bytes = 1024;
constexpr std::size_t max_trailer_bytes = 8192;
constexpr std::size_t max_size_digits = 15;  // below 2^60

[[noreturn]] void refuse() { throw Error("http.bad_request", "The framing of the body's chunks is broken."); }

std::uint64_t chunk_size(const std::string& line) {
  const auto digits = std::min(line.find_first_of("; \t"), line.size());
  std::uint64_t size = 0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + digits, size, 16);
  if (digits == 0 || digits > max_size_digits || error != std::errc() || end != line.data() + digits) refuse();
  return size;
}

}  // namespace

bool ChunkedBody::take_line(std::string& input, std::size_t& used, std::string& line) const {
  const auto end = input.find('\n', used);
  if (end == std::string::npos ? input.size() - used > max_line_bytes : end - used > max_line_bytes) refuse();
  if (end == std::string::npos) return false;
  if (end == used || input[end - 1] != '\r') refuse();
  line = input.substr(used, end - 1 - used);
  used = end + 1;
  return true;
}

bool ChunkedBody::take(std::string& input, std::string& body) {
  std::size_t used = 0;
  std::string line;
  bool waits = false;
  while (!waits && place_ != Place::done) {
    switch (place_) {
      case Place::size:
        if ((waits = !take_line(input, used, line))) break;
        left_ = chunk_size(line);
        place_ = left_ > 0 ? Place::data : Place::trailer;
        break;
      case Place::data: {
        const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(left_, input.size() - used));
        body.append(input, used, count);
        used += count;
        left_ -= count;
        waits = left_ > 0;
        if (!waits) place_ = Place::end_of_data;
        break;
      }
      case Place::end_of_data:
        if ((waits = !take_line(input, used, line))) break;
        if (!line.empty()) refuse();
        place_ = Place::size;
        break;
      case Place::trailer:
        if ((waits = !take_line(input, used, line))) break;
        trailer_bytes_ += line.size();
        if (trailer_bytes_ > max_trailer_bytes) refuse();
        if (line.empty()) place_ = Place::done;
        break;
      case Place::done:
        break;
    }
  }
  input.erase(0, used);
  return place_ == Place::done;
}

}  // namespace supple::http
