#include <algorithm>
#include <charconv>

#include "supple/json/requests.h"

namespace supple::json {
namespace {

std::string_view without_blanks(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  return text;
}

/// The number after a colon; 0 where there is none.
double number_after_colon(std::string_view text) {
  text = without_blanks(text);
  if (!text.starts_with(':')) return 0;
  text = without_blanks(text.substr(1));
  double value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

}  // namespace

double peek_deadline(std::string_view body, const Limits& limits) {
  double deadline = 0;
  int depth = 0;
  for (std::size_t i = 0; i < body.size(); ++i) {
    if (body[i] == '{' || body[i] == '[') ++depth;
    if (body[i] == '}' || body[i] == ']') --depth;
    if (body[i] != '"') continue;
    const std::size_t begin = ++i;
    while (i < body.size() && body[i] != '"') i += body[i] == '\\' ? 2 : 1;
    i = std::min(i, body.size());
    if (depth == 1 && body.substr(begin, i - begin) == "deadline")
      deadline = number_after_colon(body.substr(std::min(i + 1, body.size())));
  }
  return std::min(deadline > 0 ? deadline : limits.default_deadline, limits.max_deadline);
}

}  // namespace supple::json
