#include "supple/design/measured_table.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "supple/base/error.h"

namespace supple::design {
namespace {

constexpr std::size_t most_rows = 1'000'000;
constexpr std::size_t most_columns = 256;
/// So many lines tell how all of them are written.
constexpr std::size_t most_told_by = 5000;
constexpr std::size_t lines_between_checks = 4096;
constexpr double missing = std::numeric_limits<double>::quiet_NaN();

struct Format {
  char delimiter;
  char decimal;
};

// Where several read the text as well, the first does: "1,2" is two whole numbers.
constexpr std::array<Format, 7> formats{
    {{'\t', '.'}, {';', '.'}, {',', '.'}, {' ', '.'}, {'\t', ','}, {';', ','}, {' ', ','}}};

bool is_blank(char c) { return c == ' ' || c == '\t'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// Lines end with a line feed, a carriage return, or both.
std::vector<std::string_view> lines_of(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const auto end = text.find_first_of("\r\n");
    lines.push_back(text.substr(0, end));
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + (text.substr(end).starts_with("\r\n") ? 2 : 1));
  }
  return lines;
}

/// Calls visit(cell) for each cell of a line, without its quotes. A quoted cell may hold the delimiter.
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

std::optional<double> number_in(std::string_view cell, char decimal) {
  if (cell.starts_with('+')) cell.remove_prefix(1);
  constexpr std::size_t longest = 48;
  if (cell.empty() || cell.size() > longest) return std::nullopt;
  std::array<char, longest> digits;
  std::copy(cell.begin(), cell.end(), digits.begin());
  if (decimal == ',') {
    for (std::size_t i = 0; i < cell.size(); ++i) {
      if (digits[i] == '.') return std::nullopt;
      if (digits[i] == ',') digits[i] = '.';
    }
  }
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + cell.size(), value);
  if (error != std::errc() || end != digits.data() + cell.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// How many cells a line has, how many of them hold numbers, and how many something else.
struct LineShape {
  std::size_t cells = 0;
  std::size_t numbers = 0;
  std::size_t others = 0;
  bool is_row() const { return numbers >= 2; }
};

LineShape shape_of(std::string_view line, Format format) {
  LineShape shape;
  for_each_cell(line, format.delimiter, [&](std::string_view cell) {
    ++shape.cells;
    if (number_in(cell, format.decimal)) {
      ++shape.numbers;
    } else if (!cell.empty()) {
      ++shape.others;
    }
  });
  return shape;
}

/// The rows that a format finds: those with as many cells as most have.
struct Reading {
  std::size_t cells = 0;
  std::size_t rows = 0;
  /// Numbers less cells that are none: read with the wrong separators, "0,5;1,5;2,5" has numbers at its ends and none
  /// between.
  std::int64_t score = 0;
};

Reading reading_of(std::span<const std::string_view> lines, Format format) {
  std::map<std::size_t, Reading> by_cells;
  for (const auto line : lines) {
    const LineShape shape = shape_of(line, format);
    if (!shape.is_row()) continue;
    Reading& reading = by_cells[shape.cells];
    reading.cells = shape.cells;
    ++reading.rows;
    reading.score += static_cast<std::int64_t>(shape.numbers) - static_cast<std::int64_t>(shape.others);
  }
  Reading usual;
  for (const auto& [cells, reading] : by_cells) {
    if (reading.rows > usual.rows) usual = reading;
  }
  return usual;
}

/// Latin-1 becomes UTF-8: what follows goes on to clients as JSON.
std::string as_utf8(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    std::size_t length = 1;
    if (byte >= 0xC2 && byte < 0xE0) length = 2;
    if (byte >= 0xE0 && byte < 0xF0) length = 3;
    if (byte < 0x20) {
      out += ' ';
      continue;
    }
    bool is_sequence = length > 1 && i + length <= text.size();
    for (std::size_t k = 1; k < length && is_sequence; ++k) {
      is_sequence = (static_cast<unsigned char>(text[i + k]) & 0xC0) == 0x80;
    }
    // Forms that UTF-8 forbids: overlong ones and surrogates.
    if (length == 3 && is_sequence) {
      const auto next = static_cast<unsigned char>(text[i + 1]);
      is_sequence = !(byte == 0xE0 && next < 0xA0) && !(byte == 0xED && next >= 0xA0);
    }
    if (byte < 0x80) {
      out += text[i];
    } else if (is_sequence) {
      out += text.substr(i, length);
      i += length - 1;
    } else {
      out += static_cast<char>(0xC0 | (byte >> 6));
      out += static_cast<char>(0x80 | (byte & 0x3F));
    }
  }
  return out;
}

/// "Strain [%]", "Stress (MPa)", "force/N" and "Dehnung in %" name their unit.
std::pair<std::string, std::string> name_and_unit(std::string_view header) {
  for (const auto& [open, close] : {std::pair('[', ']'), std::pair('(', ')')}) {
    const auto begin = header.rfind(open);
    if (begin == std::string_view::npos) continue;
    const auto end = header.find(close, begin);
    if (end == std::string_view::npos) continue;
    return {as_utf8(trimmed(header.substr(0, begin))), as_utf8(trimmed(header.substr(begin + 1, end - begin - 1)))};
  }
  for (const std::string_view word : {" in ", " / ", "/"}) {
    const auto at = header.rfind(word);
    // "N/mm^2" alone, or the slash within a unit, is no name of a quantity and its unit.
    if (at == std::string_view::npos || at == 0 || header.find('/') != header.rfind('/')) continue;
    return {as_utf8(trimmed(header.substr(0, at))), as_utf8(trimmed(header.substr(at + word.size())))};
  }
  return {as_utf8(header), {}};
}

bool is_bracketed(std::string_view cell) {
  return cell.size() > 1 &&
         ((cell.front() == '[' && cell.back() == ']') || (cell.front() == '(' && cell.back() == ')'));
}

std::vector<std::string_view> cells_of(std::string_view line, char delimiter) {
  std::vector<std::string_view> cells;
  for_each_cell(line, delimiter, [&](std::string_view cell) { cells.push_back(cell); });
  return cells;
}

/// Whether a line may be the header of a table of as many columns. Blanks separate words of names too, so that there
/// any line with as many cells will do.
bool is_header(std::string_view line, Format format, std::size_t columns) {
  const LineShape shape = shape_of(line, format);
  return shape.cells == columns && shape.numbers == 0 && !trimmed(line).empty();
}

/// Names and units from the one or two lines before the first row; returns how many they are.
std::size_t read_header(const std::vector<std::string_view>& lines, std::size_t first_row, Format format,
                        MeasuredTable& table) {
  const std::size_t columns = table.columns.size();
  if (first_row == 0 || !is_header(lines[first_row - 1], format, columns)) return 0;
  const auto last = cells_of(lines[first_row - 1], format.delimiter);
  const bool two = first_row > 1 && is_header(lines[first_row - 2], format, columns) &&
                   std::any_of(last.begin(), last.end(), is_bracketed) &&
                   std::all_of(last.begin(), last.end(), [](auto cell) { return cell.empty() || is_bracketed(cell); });
  const auto names = two ? cells_of(lines[first_row - 2], format.delimiter) : last;
  for (std::size_t c = 0; c < columns; ++c) {
    std::tie(table.columns[c].name, table.columns[c].unit) = name_and_unit(names[c]);
    if (two && !last[c].empty()) table.columns[c].unit = as_utf8(trimmed(last[c].substr(1, last[c].size() - 2)));
  }
  return two ? 2 : 1;
}

[[noreturn]] void refuse_table(const std::string& message) {
  throw Error("design.unreadable_table", message, {{"text", message}});
}

}  // namespace

MeasuredTable read_table(std::string_view text, const CancellationToken& cancellation) {
  const auto lines = lines_of(text);
  Format format = formats[0];
  Reading best;
  const auto told_by = std::span(lines).first(std::min(lines.size(), most_told_by));
  for (const Format candidate : formats) {
    cancellation.throw_if_requested();
    const Reading reading = reading_of(told_by, candidate);
    if (reading.rows == 0 || (best.rows > 0 && reading.score <= best.score)) continue;
    format = candidate;
    best = reading;
  }
  const std::size_t columns = best.cells;
  if (best.rows == 0) {
    refuse_table(
        "No line of the text holds two numbers: a table has columns that commas, semicolons, tabs or blanks separate, "
        "one "
        "row in a line.");
  }
  if (columns > most_columns) {
    refuse_table("The table has " + std::to_string(columns) + " columns, the limit is " + std::to_string(most_columns) +
                 ".");
  }
  MeasuredTable table;
  table.delimiter = format.delimiter;
  table.decimal_separator = format.decimal;
  table.columns.resize(columns);
  std::optional<std::size_t> first_row;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (i % lines_between_checks == 0) cancellation.throw_if_requested();
    const LineShape shape = shape_of(lines[i], format);
    if (!shape.is_row() || shape.cells != columns) {
      if (!trimmed(lines[i]).empty()) ++table.skipped_lines;
      continue;
    }
    if (!first_row) first_row = i;
    if (table.rows() == most_rows)
      refuse_table("The table has more than " + std::to_string(most_rows) + " rows, which is the limit.");
    std::size_t c = 0;
    for_each_cell(lines[i], format.delimiter, [&](std::string_view cell) {
      table.columns[c++].values.push_back(number_in(cell, format.decimal).value_or(missing));
    });
  }
  table.skipped_lines -= read_header(lines, *first_row, format, table);
  return table;
}

}  // namespace supple::design
