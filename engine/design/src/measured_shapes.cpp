#include "measured_shapes.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>

#include "measured_lines.h"
#include "measured_numbers.h"
#include "supple/base/error.h"

namespace supple::design {
namespace {

/// So many lines tell how all of them are divided.
constexpr std::size_t max_telling_lines = 5000;

// Where several read the text as well, the first does.
constexpr std::array<char, 4> delimiters{'\t', ';', ',', ' '};

bool is_row(std::string_view shape) { return count_kind(shape, 'N') >= 2; }

/// Numbers less texts of the rows with as many cells as most have: read with the wrong delimiter, "0,5;1,5;2,5" has
/// numbers at its ends and none between. Nothing where no line is a row.
std::optional<std::int64_t> score_of(std::span<const std::string_view> lines, TableFormat format) {
  struct Rows {
    std::size_t count = 0;
    std::int64_t score = 0;
  };
  std::map<std::size_t, Rows> by_cells;
  for (const auto line : lines) {
    const std::string shape = shape_of(line, format);
    if (!is_row(shape)) continue;
    Rows& rows = by_cells[shape.size()];
    ++rows.count;
    rows.score += static_cast<std::int64_t>(count_kind(shape, 'N')) - static_cast<std::int64_t>(count_kind(shape, 'T'));
  }
  Rows usual;
  for (const auto& [cells, rows] : by_cells) {
    if (rows.count > usual.count) usual = rows;
  }
  return usual.count == 0 ? std::nullopt : std::optional(usual.score);
}

/// A spreadsheet's first line "sep=;" names the delimiter.
std::optional<char> named_delimiter(std::span<const std::string_view> lines) {
  constexpr std::string_view word = "sep=";
  if (lines.empty()) return std::nullopt;
  std::string_view line = lines.front();
  while (line.starts_with('"')) line.remove_prefix(1);
  if (!line.starts_with(word) || line.size() < word.size() + 1) return std::nullopt;
  const char named = line[word.size()];
  if (std::find(delimiters.begin(), delimiters.end(), named) == delimiters.end()) return std::nullopt;
  return named;
}

/// What the cells of rows tell about the decimal separator, each kind with the first cell that tells it.
struct Evidence {
  std::string_view point, comma, ambiguous;

  void add(std::string_view cell, bool blanks) {
    const DecimalEvidence told = decimal_evidence(cell, blanks);
    std::string_view* const first = told == DecimalEvidence::point       ? &point
                                    : told == DecimalEvidence::comma     ? &comma
                                    : told == DecimalEvidence::ambiguous ? &ambiguous
                                                                         : nullptr;
    if (first && first->empty()) *first = cell;
  }
};

[[noreturn]] void refuse_decimals(const std::string& why) {
  const std::string message = "must be \"point\" or \"comma\": " + why;
  throw Error("design.invalid_measurement", "decimal_separator: " + message + ".", {{"decimal_separator", message}});
}

char decimal_of(std::span<const std::string_view> lines, char delimiter, const CancellationToken& cancellation) {
  const bool blanks = TableFormat{delimiter, '.'}.blanks();
  Evidence evidence;
  bool has_quoted_comma = false;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (i % lines_between_checks == 0) cancellation.throw_if_requested();
    // Of a long file its beginning tells, where it does.
    if (i > max_telling_lines && (!evidence.point.empty() || !evidence.comma.empty())) break;
    std::size_t numbers = 0, words = 0;
    Evidence of_line;
    bool comma_in_cell = false;
    for_each_cell(lines[i], delimiter, [&](std::string_view cell) {
      const bool is_number = number_in(cell, '.', blanks) || number_in(cell, ',', blanks);
      if (!is_number) {
        words += cell.empty() || is_missing_mark(cell) ? 0U : 1U;
        return;
      }
      ++numbers;
      comma_in_cell |= cell.find(',') != std::string_view::npos;
      of_line.add(cell, blanks);
    });
    // Remarks tell little: "Version 2.1" is written by a program, "2,5" by a person.
    if (numbers < 2 || numbers < words) continue;
    has_quoted_comma |= comma_in_cell;
    if (evidence.point.empty()) evidence.point = of_line.point;
    if (evidence.comma.empty()) evidence.comma = of_line.comma;
    if (evidence.ambiguous.empty()) evidence.ambiguous = of_line.ambiguous;
  }
  const auto quoted = [](std::string_view cell) { return "\"" + std::string(cell) + "\""; };
  if (!evidence.point.empty() && !evidence.comma.empty()) {
    refuse_decimals("the file has " + quoted(evidence.point) + ", which has a decimal point, and " +
                    quoted(evidence.comma) + ", which has a decimal comma");
  }
  if (!evidence.comma.empty()) return ',';
  if (!evidence.point.empty() || evidence.ambiguous.empty()) return '.';
  // Where commas separate the cells and no number has one, a point that separates thousands would be strange.
  if (delimiter == ',' && !has_quoted_comma) return '.';
  const auto point = number_in(evidence.ambiguous, '.', blanks), comma = number_in(evidence.ambiguous, ',', blanks);
  const auto shown = [](double value) {
    std::string text = std::to_string(value);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.ends_with('.')) text.pop_back();
    return text;
  };
  refuse_decimals(quoted(evidence.ambiguous) + " is " + shown(point->value) + " with the one and " +
                  shown(comma->value) + " with the other, and no other number of the file tells");
}

}  // namespace

void refuse_table(const std::string& message) { throw Error("design.unreadable_table", message, {{"text", message}}); }

char cell_kind(std::string_view cell, TableFormat format) {
  if (cell.empty()) return 'E';
  if (number_in(cell, format.decimal, format.blanks())) return 'N';
  return is_missing_mark(cell) ? 'M' : 'T';
}

std::string shape_of(std::string_view line, TableFormat format) {
  std::string shape;
  for_each_cell(line, format.delimiter, [&](std::string_view cell) { shape += cell_kind(cell, format); });
  return shape;
}

std::size_t count_kind(std::string_view shape, char kind) {
  return static_cast<std::size_t>(std::count(shape.begin(), shape.end(), kind));
}

TableFormat format_of(std::span<const std::string_view> lines, std::optional<char> decimal,
                      const CancellationToken& cancellation) {
  // The first lines may be remarks alone.
  std::size_t begin = 0;
  std::optional<std::int64_t> best;
  TableFormat format;
  const auto named = named_delimiter(lines);
  while (begin < lines.size() && !best) {
    const auto telling = lines.subspan(begin, std::min(lines.size() - begin, max_telling_lines));
    for (const char delimiter : delimiters) {
      if (named && delimiter != *named) continue;
      cancellation.throw_if_requested();
      for (const char separator : {'.', ','}) {
        if (decimal && separator != *decimal) continue;
        const auto score = score_of(telling, {delimiter, separator});
        if (!score || (best && *score <= *best)) continue;
        best = score;
        format.delimiter = delimiter;
      }
    }
    begin += max_telling_lines;
  }
  if (!best) {
    refuse_table(
        "No line of the text holds two numbers: a table has columns that commas, semicolons, tabs or blanks separate, "
        "one row in a line.");
  }
  format.decimal = decimal ? *decimal : decimal_of(lines, format.delimiter, cancellation);
  return format;
}

}  // namespace supple::design
