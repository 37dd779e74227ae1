#include "measured_shapes.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>

#include "measured_lines.h"
#include "measured_numbers.h"
#include "supple/base/number_text.h"
#include "supple/design/design_fault.h"

namespace supple::design {
namespace {

/// Maximum number of lines from which the delimiter is determined.
constexpr std::size_t max_sampled_lines = 5000;

// If several delimiters fit equally well, the first one of these is taken.
constexpr std::array<char, 4> delimiters{'\t', ';', ',', ' '};

bool is_row(std::string_view shape) { return count_kind(shape, 'N') >= 2; }

/// Number of cells with numbers minus number of cells with text, in the rows that have the most common number of cells.
/// Text counts, because with a wrong delimiter "0,5;1,5;2,5" has numbers at its ends and text between them. None if no
/// line is a row.
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

/// The delimiter in a spreadsheet's first line "sep=;"; none without such a line.
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

/// For each kind of evidence about the decimal separator, the first cell that gives it.
struct SeparatorEvidence {
  std::string_view point, comma, ambiguous;

  void add(std::string_view cell, bool blank_thousands) {
    const DecimalEvidence cell_evidence = decimal_evidence(cell, blank_thousands);
    std::string_view* const first = cell_evidence == DecimalEvidence::point       ? &point
                                    : cell_evidence == DecimalEvidence::comma     ? &comma
                                    : cell_evidence == DecimalEvidence::ambiguous ? &ambiguous
                                                                                  : nullptr;
    if (first && first->empty()) *first = cell;
  }
};

[[noreturn]] void refuse_decimals(const std::string& why) {
  const std::string message = "must be \"point\" or \"comma\": " + why;
  throw MeasurementFault("design.invalid_measurement", "decimal_separator: " + message + ".",
                         {{"decimal_separator", message}});
}

char decimal_of(std::span<const std::string_view> lines, char delimiter, const CancellationToken& cancellation) {
  const bool blank_thousands = TableFormat{delimiter, '.'}.blank_thousands();
  SeparatorEvidence evidence;
  bool has_quoted_comma = false;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (i % lines_between_checks == 0) cancellation.throw_if_requested();
    // In a long file the first lines suffice if they decide.
    if (i > max_sampled_lines && (!evidence.point.empty() || !evidence.comma.empty())) break;
    std::size_t numbers = 0, words = 0;
    SeparatorEvidence line_evidence;
    bool comma_in_cell = false;
    for_each_cell(lines[i], delimiter, [&](std::string_view cell) {
      const bool is_number = number_in(cell, '.', blank_thousands) || number_in(cell, ',', blank_thousands);
      if (!is_number) {
        words += cell.empty() || is_missing_mark(cell) ? 0U : 1U;
        return;
      }
      ++numbers;
      comma_in_cell |= cell.find(',') != std::string_view::npos;
      line_evidence.add(cell, blank_thousands);
    });
    // Remarks are no evidence: a program writes "Version 2.1" in files with decimal commas too.
    if (numbers < 2 || numbers < words) continue;
    has_quoted_comma |= comma_in_cell;
    if (evidence.point.empty()) evidence.point = line_evidence.point;
    if (evidence.comma.empty()) evidence.comma = line_evidence.comma;
    if (evidence.ambiguous.empty()) evidence.ambiguous = line_evidence.ambiguous;
  }
  const auto quoted = [](std::string_view cell) { return "\"" + std::string(cell) + "\""; };
  if (!evidence.point.empty() && !evidence.comma.empty()) {
    refuse_decimals("the file has " + quoted(evidence.point) + ", which has a decimal point, and " +
                    quoted(evidence.comma) + ", which has a decimal comma");
  }
  if (!evidence.comma.empty()) return ',';
  if (!evidence.point.empty() || evidence.ambiguous.empty()) return '.';
  // If commas separate the cells and no number contains one, a point is the decimal separator.
  if (delimiter == ',' && !has_quoted_comma) return '.';
  const auto point = number_in(evidence.ambiguous, '.', blank_thousands),
             comma = number_in(evidence.ambiguous, ',', blank_thousands);
  refuse_decimals(quoted(evidence.ambiguous) + " is " + number_text(point->value) + " with the one and " +
                  number_text(comma->value) + " with the other, and no other number of the file tells");
}

}  // namespace

void refuse_table(const std::string& message) {
  throw MeasurementFault("design.unreadable_table", message, {{"text", message}});
}

char cell_kind(std::string_view cell, TableFormat format) {
  if (cell.empty()) return 'E';
  if (number_in(cell, format.decimal, format.blank_thousands())) return 'N';
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
  // The first lines may consist of remarks alone.
  std::size_t begin = 0;
  std::optional<std::int64_t> best;
  TableFormat format;
  const auto named = named_delimiter(lines);
  while (begin < lines.size() && !best) {
    const auto sample = lines.subspan(begin, std::min(lines.size() - begin, max_sampled_lines));
    for (const char delimiter : delimiters) {
      if (named && delimiter != *named) continue;
      cancellation.throw_if_requested();
      for (const char separator : {'.', ','}) {
        if (decimal && separator != *decimal) continue;
        const auto score = score_of(sample, {delimiter, separator});
        if (!score || (best && *score <= *best)) continue;
        best = score;
        format.delimiter = delimiter;
      }
    }
    begin += max_sampled_lines;
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
