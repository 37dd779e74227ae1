#include "measured_lines.h"

#include <cstddef>
#include <utility>

namespace supple::design {
namespace {

/// Maximum number of further lines over which a quoted cell continues.
constexpr std::size_t max_joined_lines = 4;

bool has_open_quote(std::string_view line) { return std::count(line.begin(), line.end(), '"') % 2 != 0; }

}  // namespace

std::vector<std::string_view> lines_of(std::string& text) {
  std::vector<std::pair<std::size_t, std::size_t>> ranges;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = at;
    while (end < text.size() && text[end] != '\n' && text[end] != '\r') ++end;
    ranges.emplace_back(at, end);
    // Some programs end a line with two carriage returns and a line feed.
    at = end;
    while (at < text.size() && text[at] == '\r') ++at;
    const bool has_feed = at < text.size() && text[at] == '\n';
    at = has_feed ? at + 1 : std::min(end + 1, text.size());
  }
  const bool has_quotes = text.find('"') != std::string::npos;
  std::vector<std::string_view> lines;
  lines.reserve(ranges.size());
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const auto [begin, end] = ranges[i];
    const std::string_view line = std::string_view(text).substr(begin, end - begin);
    if (!has_quotes || !has_open_quote(line)) {
      lines.push_back(line);
      continue;
    }
    std::size_t last = i + 1;
    while (last < ranges.size() && last - i < max_joined_lines &&
           !has_open_quote(std::string_view(text).substr(ranges[last].first, ranges[last].second - ranges[last].first)))
      ++last;
    const bool closes = last < ranges.size() && has_open_quote(std::string_view(text).substr(
                                                    ranges[last].first, ranges[last].second - ranges[last].first));
    if (!closes) {
      lines.push_back(line);
      continue;
    }
    std::replace_if(
        text.begin() + static_cast<std::ptrdiff_t>(begin),
        text.begin() + static_cast<std::ptrdiff_t>(ranges[last].second), [](char c) { return c == '\r' || c == '\n'; },
        ' ');
    lines.push_back(std::string_view(text).substr(begin, ranges[last].second - begin));
    i = last;
  }
  return lines;
}

std::vector<std::string_view> cells_of(std::string_view line, char delimiter) {
  std::vector<std::string_view> cells;
  for_each_cell(line, delimiter, [&](std::string_view cell) { cells.push_back(cell); });
  return cells;
}

}  // namespace supple::design
