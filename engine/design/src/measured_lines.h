#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

// Lines of a table and their cells.
namespace supple::design {

inline bool is_blank(char c) { return c == ' ' || c == '\t'; }

inline std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// The lines of a text, which end with a line feed, carriage returns, or both. A cell in quotes may contain an end of
/// line, as titles of spreadsheets do. Therefore a line with an odd number of quotes is joined with the lines up to the
/// next one with an odd number. `text` is changed: the ends of joined lines become blanks.
std::vector<std::string_view> lines_of(std::string& text);

/// Calls visit(cell) for each cell of a line, without quotes and surrounding blanks. A quoted cell may contain the
/// delimiter. The delimiter ' ' stands for any number of blanks.
template <class Visit>
void for_each_cell(std::string_view line, char delimiter, Visit visit) {
  if (delimiter == ' ') line = trimmed(line);
  std::size_t at = 0;
  while (true) {
    std::size_t begin = at;
    while (begin < line.size() && is_blank(line[begin]) && line[begin] != delimiter) ++begin;
    std::size_t end = 0;
    std::string_view cell;
    if (begin < line.size() && line[begin] == '"') {
      const auto quote = std::min(line.find('"', begin + 1), line.size());
      cell = line.substr(begin + 1, quote - begin - 1);
      end = std::min(line.find(delimiter, std::min(quote + 1, line.size())), line.size());
    } else {
      end = delimiter == ' ' ? line.find_first_of(" \t", at) : line.find(delimiter, at);
      end = std::min(end, line.size());
      cell = line.substr(at, end - at);
    }
    visit(trimmed(cell));
    if (end == line.size()) return;
    at = end + 1;
    while (delimiter == ' ' && at < line.size() && is_blank(line[at])) ++at;
  }
}

std::vector<std::string_view> cells_of(std::string_view line, char delimiter);

}  // namespace supple::design
