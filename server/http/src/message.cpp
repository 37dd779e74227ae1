#include "supple/http/message.h"

#include <poll.h>
#include <strings.h>

#include <algorithm>
#include <charconv>

#include "text.h"

namespace supple::http {
namespace {

/// Calls visit(piece) for the text between separators, without outer blanks; empty pieces are skipped.
template <class Visit>
void for_each_piece(std::string_view text, char separator, Visit visit) {
  while (true) {
    const auto end = text.find(separator);
    if (const auto piece = trimmed(text.substr(0, end)); !piece.empty()) visit(piece);
    if (end == std::string_view::npos) return;
    text.remove_prefix(end + 1);
  }
}

std::optional<double> parse_number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Specificity with which a media range matches a type: 0 no match, 1 "*/*", 2 "text/*", 3 "text/plain".
int specificity_of(std::string_view range, std::string_view type) {
  if (range == type) return 3;
  if (range == "*/*") return 1;
  if (range.ends_with("/*") && type.starts_with(range.substr(0, range.size() - 1))) return 2;
  return 0;
}

}  // namespace

std::string lower_case(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return result;
}

bool Peer::hung_up() const {
  if (socket_ < 0) return false;
  pollfd entry{socket_, POLLRDHUP, 0};
  return ::poll(&entry, 1, 0) > 0 && (entry.revents & (POLLRDHUP | POLLHUP | POLLERR | POLLNVAL)) != 0;
}

std::string Request::header(std::string_view name) const {
  std::string value;
  for (const auto& [field, text] : headers) {
    if (field.size() != name.size() || strncasecmp(field.data(), name.data(), name.size()) != 0) continue;
    if (!value.empty()) value += ", ";
    value += text;
  }
  return value;
}

std::string media_type(std::string_view header) { return lower_case(trimmed(header.substr(0, header.find(';')))); }

std::optional<std::string_view> negotiate(std::string_view accept, const std::vector<std::string_view>& offered) {
  if (trimmed(accept).empty()) return offered.front();
  std::optional<std::string_view> best;
  double best_quality = 0;
  for (const auto type : offered) {
    int specificity = 0;
    double quality = 0;
    for_each_piece(accept, ',', [&](std::string_view entry) {
      const int matched = specificity_of(media_type(entry), type);
      if (matched <= specificity) return;
      specificity = matched;
      quality = 1;
      for_each_piece(entry, ';', [&](std::string_view parameter) {
        if (parameter.starts_with("q=")) quality = parse_number(parameter.substr(2)).value_or(1);
      });
    });
    if (quality > best_quality) {
      best = type;
      best_quality = quality;
    }
  }
  return best;
}

Preference parse_preference(std::string_view header, double max_wait) {
  Preference preference;
  for_each_piece(header, ',', [&](std::string_view entry) {
    const auto text = lower_case(trimmed(entry.substr(0, entry.find(';'))));
    if (text == "respond-async") preference.respond_async = true;
    if (!text.starts_with("wait=") || preference.wait) return;
    const auto seconds = parse_number(std::string_view(text).substr(5));
    if (!seconds || !(*seconds >= 0 && *seconds <= max_wait)) {
      throw Error("request.invalid_parameter", "The header Prefer has '" + text + "'; wait takes seconds from 0 to " +
                                                   std::to_string(static_cast<int>(max_wait)) + ".");
    }
    preference.wait = *seconds;
  });
  return preference;
}

}  // namespace supple::http
