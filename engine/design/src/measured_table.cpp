#include "supple/design/measured_table.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "measured_header.h"
#include "measured_lines.h"
#include "measured_numbers.h"
#include "measured_shapes.h"
#include "supple/design/design_fault.h"
#include "supple/design/measured_curve.h"

namespace supple::design {
namespace {

constexpr std::size_t max_rows = 1'000'000;
constexpr std::size_t max_columns = 256;
constexpr std::size_t max_remark_bytes = 20'000;
/// Maximum ratio of the longest block's rows to those of a block that is read by default. Shorter blocks are probably
/// summaries.
constexpr std::size_t max_block_ratio = 10;
constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// All cells of a file, each parsed once.
struct ParsedLines {
  std::vector<std::string> shapes;       ///< the kinds of each line's cells, as shape_of
  std::vector<std::size_t> first_cells;  ///< index of each line's first cell in `values`
  std::vector<double> values;            ///< numbers of all cells; NaN for a cell without a number
  std::vector<std::size_t> percents;     ///< indices of cells whose number ends with "%", in increasing order

  ParsedLines(std::span<const std::string_view> lines, TableFormat format, const CancellationToken& cancellation) {
    shapes.reserve(lines.size());
    first_cells.reserve(lines.size());
    for (const auto line : lines) {
      if (shapes.size() % lines_between_checks == 0) cancellation.throw_if_requested();
      first_cells.push_back(values.size());
      std::string& shape = shapes.emplace_back();
      for_each_cell(line, format.delimiter, [&](std::string_view cell) {
        const auto number = number_in(cell, format.decimal, format.blank_thousands());
        if (number && number->has_percent) percents.push_back(values.size());
        values.push_back(number ? number->value : missing);
        shape += number ? 'N' : cell_kind(cell, format);
      });
    }
  }

  bool has_percent(std::size_t cell) const {
    return !percents.empty() && std::binary_search(percents.begin(), percents.end(), cell);
  }
};

/// The number of cells in a row, and the columns in which most of the rows have numbers.
struct RowShape {
  std::size_t columns = 0;
  std::vector<bool> is_numeric;

  bool fits(std::string_view shape) const {
    if (shape.size() != columns || count_kind(shape, 'N') < 2) return false;
    for (std::size_t c = 0; c < columns; ++c) {
      if (shape[c] == 'T' && is_numeric[c]) return false;
    }
    return true;
  }
};

RowShape usual_shape(const std::vector<std::string>& shapes) {
  std::map<std::size_t, std::size_t> lines_by_cells;
  for (const auto& shape : shapes) {
    if (count_kind(shape, 'N') >= 2) ++lines_by_cells[shape.size()];
  }
  RowShape row;
  std::size_t max_lines = 0;
  for (const auto& [cells, lines] : lines_by_cells) {
    if (lines > max_lines) row.columns = cells;
    max_lines = std::max(max_lines, lines);
  }
  std::vector<std::size_t> numbers(row.columns), texts(row.columns);
  for (const auto& shape : shapes) {
    if (shape.size() != row.columns || count_kind(shape, 'N') < 2) continue;
    for (std::size_t c = 0; c < row.columns; ++c) {
      numbers[c] += shape[c] == 'N' ? 1U : 0U;
      texts[c] += shape[c] == 'T' ? 1U : 0U;
    }
  }
  for (std::size_t c = 0; c < row.columns; ++c) row.is_numeric.push_back(numbers[c] > texts[c]);
  return row;
}

/// Consecutive rows of one specimen. Lines and rows are indices in the whole file.
struct Block {
  std::size_t first_line = 0, last_line = 0;
  std::size_t above = 0;  ///< first line after the previous block
  std::size_t first_row = 0, rows = 0;
  std::size_t malformed_lines = 0;
};

/// Reads the rows and divides them into blocks.
class BlockReader {
 public:
  BlockReader(std::span<const std::string_view> lines, const ParsedLines& parsed, TableFormat format, RowShape row)
      : lines_(lines),
        parsed_(parsed),
        shapes_(parsed.shapes),
        format_(format),
        row_(std::move(row)),
        values_(row_.columns),
        percents_(row_.columns),
        increases_(row_.columns, true) {}

  void read(const CancellationToken& cancellation) {
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      if (i % lines_between_checks == 0) cancellation.throw_if_requested();
      if (!row_.fits(shapes_[i])) continue;
      if (rows_ == max_rows)
        refuse_table("The table has more than " + std::to_string(max_rows) + " rows, which is the limit.");
      add_row(i);
    }
  }

  const std::vector<Block>& blocks() const { return blocks_; }
  const std::vector<std::vector<double>>& values() const { return values_; }
  const std::vector<std::vector<bool>>& percents() const { return percents_; }
  std::vector<bool> has_numbers() const { return row_.is_numeric; }

 private:
  void add_row(std::size_t line) {
    for (std::size_t c = 0; c < row_.columns; ++c) {
      const std::size_t cell = parsed_.first_cells[line] + c;
      values_[c].push_back(parsed_.values[cell]);
      percents_[c].push_back(parsed_.has_percent(cell));
    }
    if (blocks_.empty() || ends_before(line)) {
      Block block;
      block.above = blocks_.empty() ? 0 : blocks_.back().last_line + 1;
      block.first_line = line;
      block.first_row = rows_;
      blocks_.push_back(block);
      increases_.assign(row_.columns, true);
    } else {
      Block& block = blocks_.back();
      for (std::size_t i = block.last_line + 1; i < line; ++i) block.malformed_lines += has_number(i) ? 1U : 0U;
      for (std::size_t k = 0; k < row_.columns; ++k) increases_[k] = increases_[k] && !decreases(k);
    }
    blocks_.back().last_line = line;
    ++blocks_.back().rows;
    ++rows_;
  }

  bool has_number(std::size_t line) const { return count_kind(shapes_[line], 'N') > 0; }

  /// Whether the last value of a column is less than the one before.
  bool decreases(std::size_t column) const {
    const auto& v = values_[column];
    return v.size() > 1 && v[v.size() - 1] < v[v.size() - 2];
  }

  /// Whether a column that only increased in this block decreases with the last row.
  bool starts_again() const {
    if (blocks_.back().rows < 2) return false;
    for (std::size_t c = 0; c < row_.columns; ++c) {
      const bool increased = increases_[c] && values_[c][rows_ - 1] > values_[c][blocks_.back().first_row];
      if (increased && decreases(c)) return true;
    }
    return false;
  }

  bool ends_before(std::size_t line) const {
    const Block& block = blocks_.back();
    if (line == block.last_line + 1) return false;
    const bool is_restart = starts_again();
    bool has_gap = false;
    for (std::size_t i = block.last_line + 1; i < line; ++i) {
      if (has_number(i) && count_kind(shapes_[i], 'T') < 2) continue;
      has_gap = true;
      if (is_titles_line(lines_[i], format_, row_.is_numeric) && (repeats_titles(i) || block_has_no_titles()))
        return true;
    }
    return has_gap && is_restart;
  }

  /// Whether the line has the same words as a line above the first block.
  bool repeats_titles(std::size_t line) const {
    const auto words = [&](std::size_t at) {
      std::string text;
      for (const auto cell : cells_of(lines_[at], format_.delimiter)) {
        if (cell_kind(cell, format_) == 'T') text.append(cell).append("\n");
      }
      return text;
    };
    const std::string here = words(line);
    for (std::size_t i = blocks_.front().first_line; i-- > 0;) {
      if (words(i) == here) return true;
    }
    return false;
  }

  bool block_has_no_titles() const {
    for (std::size_t i = blocks_.back().above; i < blocks_.back().first_line; ++i) {
      if (is_titles_line(lines_[i], format_, row_.is_numeric)) return false;
    }
    return true;
  }

  std::span<const std::string_view> lines_;
  const ParsedLines& parsed_;
  const std::vector<std::string>& shapes_;
  TableFormat format_;
  RowShape row_;
  std::vector<std::vector<double>> values_;
  std::vector<std::vector<bool>> percents_;
  std::vector<bool> increases_;
  std::vector<Block> blocks_;
  std::size_t rows_ = 0;
};

std::size_t chosen_block(const std::vector<Block>& blocks, std::optional<std::size_t> requested) {
  if (requested) {
    if (*requested < blocks.size()) return *requested;
    const std::string message = "must be below " + std::to_string(blocks.size()) + ", the blocks of rows in the file";
    throw MeasurementFault("design.invalid_measurement", "block: " + message + ".", {{"block", message}});
  }
  std::size_t longest = 0;
  for (const Block& block : blocks) longest = std::max(longest, block.rows);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    if (max_block_ratio * blocks[b].rows >= longest) return b;
  }
  return 0;
}

/// Sets the unit of a column with cells such as "5.00%" to %. Numbers without the sign in such a column become missing,
/// except 0.
void apply_percent_signs(MeasuredTable::Column& column, const std::vector<bool>& percents, std::size_t first_row) {
  bool any = false;
  for (std::size_t r = 0; r < column.values.size(); ++r) any |= percents[first_row + r];
  if (!any) return;
  for (std::size_t r = 0; r < column.values.size(); ++r) {
    if (!percents[first_row + r] && column.values[r] != 0) column.values[r] = missing;
  }
  // A spreadsheet shows 0.05 as 5 %. The sign therefore overrides the title, unless the title's unit is not one of a
  // ratio.
  if (column.unit.empty() || canonical_unit(column.unit) == "1" || canonical_unit(column.unit) == "%")
    column.unit = "%";
}

std::string remarks_above(std::span<const std::string_view> above, const TableHeader& header) {
  std::string remarks;
  for (std::size_t i = 0; i < above.size(); ++i) {
    if (std::find(header.lines.begin(), header.lines.end(), i) != header.lines.end()) continue;
    if (remarks.size() + above[i].size() > max_remark_bytes) break;
    remarks.append(above[i]).append("\n");
  }
  return remarks;
}

}  // namespace

std::size_t MeasuredTable::Column::number_count() const {
  return static_cast<std::size_t>(
      std::count_if(values.begin(), values.end(), [](double value) { return !std::isnan(value); }));
}

MeasuredTable read_table(std::string_view text, const TableOptions& options, const CancellationToken& cancellation) {
  std::string owned(text.starts_with("\xEF\xBB\xBF") ? text.substr(3) : text);
  std::replace_if(
      owned.begin(), owned.end(),
      [](char c) { return static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r'; }, ' ');
  const auto lines = lines_of(owned);
  const TableFormat format = format_of(lines, options.decimal_separator, cancellation);
  const ParsedLines parsed(lines, format, cancellation);
  const auto& shapes = parsed.shapes;
  const RowShape row = usual_shape(shapes);
  if (row.columns == 0) refuse_table("No line of the text holds two numbers with this decimal separator.");
  if (row.columns > max_columns) {
    refuse_table("The table has " + std::to_string(row.columns) + " columns, the limit is " +
                 std::to_string(max_columns) + ".");
  }
  BlockReader reader(lines, parsed, format, row);
  reader.read(cancellation);
  const auto& blocks = reader.blocks();
  if (blocks.empty()) {
    refuse_table("Each line with two numbers or more has words in a column where most lines have numbers.");
  }
  MeasuredTable table;
  table.block = chosen_block(blocks, options.block);
  table.blocks = blocks.size();
  table.delimiter = format.delimiter;
  table.decimal_separator = format.decimal;
  const Block& block = blocks[table.block];
  table.malformed_lines = block.malformed_lines;
  // Lines of numbers directly before and after the block were probably meant as rows.
  for (std::size_t i = block.last_line + 1; i < lines.size() && count_kind(shapes[i], 'N') >= 2 && !row.fits(shapes[i]);
       ++i)
    ++table.malformed_lines;
  for (std::size_t i = block.first_line;
       i-- > block.above && count_kind(shapes[i], 'N') >= 2 && count_kind(shapes[i], 'T') == 0;)
    ++table.malformed_lines;
  if (table.malformed_lines >= block.rows) {
    refuse_table("Lines with numbers have different numbers of cells: " + std::to_string(block.rows) + " have " +
                 std::to_string(row.columns) + ", " + std::to_string(table.malformed_lines) +
                 " others do not. Decimal commas may stand between the same commas that separate the columns.");
  }
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!row.fits(shapes[i]) && !trimmed(lines[i]).empty()) ++table.skipped_lines;
  }
  const auto above = std::span(lines).subspan(block.above, block.first_line - block.above);
  TableHeader header = read_header(above, format, row.is_numeric);
  // A program may write titles only once, above all blocks.
  for (std::size_t b = table.block; b-- > 0 && header.lines.empty();) {
    const auto earlier = std::span(lines).subspan(blocks[b].above, blocks[b].first_line - blocks[b].above);
    header = read_header(earlier, format, row.is_numeric);
  }
  const bool all_integers = std::all_of(reader.values().begin(), reader.values().end(), [](const auto& values) {
    return std::all_of(values.begin(), values.end(), [](double v) { return std::isnan(v) || v == std::floor(v); });
  });
  if (format.delimiter == ',' && header.half_title_count > 0 && all_integers) {
    refuse_table(
        "The rows have twice as many cells as there are titles: decimal commas stand between the same commas "
        "that separate the columns. Separate these by semicolons, or write decimal points.");
  }
  table.skipped_lines -= header.lines.size();
  table.unmatched_titles = header.unmatched;
  table.remarks = remarks_above(above, header);
  table.columns.resize(row.columns);
  for (std::size_t c = 0; c < row.columns; ++c) {
    auto& column = table.columns[c];
    if (!header.titles.empty()) {
      column.title = header.titles[c];
      column.name = header.names[c];
    }
    column.unit = header.units[c];
    const auto begin = reader.values()[c].begin() + static_cast<std::ptrdiff_t>(block.first_row);
    column.values.assign(begin, begin + static_cast<std::ptrdiff_t>(block.rows));
    apply_percent_signs(column, reader.percents()[c], block.first_row);
  }
  // Commas at the ends of rows give an empty last column.
  while (table.columns.size() > 2 && table.columns.back().title.empty() && table.columns.back().number_count() == 0)
    table.columns.pop_back();
  return table;
}

}  // namespace supple::design
