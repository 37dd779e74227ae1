#include <algorithm>
#include <charconv>

#include "supple/json/requests.h"

namespace supple::json {
namespace {

std::string_view without_blanks(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  return text;
}

/// Calls visit(text) with what follows the outermost field of this name and its colon, each time that the field is
/// there.
template <class Visit>
void visit_outermost(std::string_view body, std::string_view name, const Visit& visit) {
  int depth = 0;
  for (std::size_t i = 0; i < body.size(); ++i) {
    if (body[i] == '{' || body[i] == '[') ++depth;
    if (body[i] == '}' || body[i] == ']') --depth;
    if (body[i] != '"') continue;
    const std::size_t begin = ++i;
    while (i < body.size() && body[i] != '"') i += body[i] == '\\' ? 2 : 1;
    i = std::min(i, body.size());
    if (depth != 1 || body.substr(begin, i - begin) != name) continue;
    const auto rest = without_blanks(body.substr(std::min(i + 1, body.size())));
    if (rest.starts_with(':')) visit(without_blanks(rest.substr(1)));
  }
}

}  // namespace

double peek_deadline(std::string_view body, const Limits& limits) {
  double deadline = 0;
  visit_outermost(body, "deadline", [&](std::string_view text) {
    deadline = 0;
    std::from_chars(text.data(), text.data() + text.size(), deadline);
  });
  return std::min(deadline > 0 ? deadline : limits.default_deadline, limits.max_deadline);
}

std::optional<Priority> peek_priority(std::string_view body) {
  std::optional<Priority> priority;
  visit_outermost(body, "priority", [&](std::string_view text) {
    priority.reset();
    if (!text.starts_with('"')) return;
    text.remove_prefix(1);
    priority = priority_of(text.substr(0, text.find('"')));
  });
  return priority;
}

}  // namespace supple::json
