#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "supple/base/cancellation.h"

namespace supple::design {

/// A table of measurements, as instruments and spreadsheets write it.
struct MeasuredTable {
  struct Column {
    std::string name;            ///< of the header, without its unit; empty without a header
    std::string unit;            ///< as the header writes it: "%", "kPa"; empty where it names none
    std::vector<double> values;  ///< one for each row; NaN where the cell holds no number
  };
  std::vector<Column> columns;    ///< at least two, all of the same length
  char delimiter = ',';           ///< between cells: ',', ';', a tab, or ' ' for any number of blanks
  char decimal_separator = '.';   ///< '.' or ','
  std::size_t skipped_lines = 0;  ///< with text that are neither rows nor the header: remarks
  std::size_t rows() const { return columns.empty() ? 0 : columns.front().values.size(); }
};

/// Reads comma, semicolon, tab or blank separated numbers with decimal points or commas: of all combinations the one
/// that finds the most numbers in the first 5000 lines. Rows have the number of cells that most rows have, and at least
/// two of them hold numbers. The line before the first row, with as many cells, is its header, "Strain [%]" or
/// "stress/MPa"; of two such lines the second holds the units. Cells may be quoted. UTF-8, Latin-1 or UTF-8 with a byte
/// order mark; lines end as on any system. Throws "design.unreadable_table" where no line is a row, or there are more
/// than 1,000,000 rows or 256 columns. O(size of the text).
MeasuredTable read_table(std::string_view text, const CancellationToken& cancellation = {});

/// A column by its index or its name (letters of either case); or the one whose name tells what it holds.
using ColumnChoice = std::variant<std::monostate, int, std::string>;

/// The columns of x and y. Where they are not named: those whose headers speak of strains, lengths or directions, and
/// of stresses, forces, stiffnesses or Poisson's ratios; without such headers the first column and the one after it.
/// Throws "design.invalid_measurement" that lists the columns, with the place "columns/x" or "columns/y".
std::pair<std::size_t, std::size_t> choose_columns(const MeasuredTable& table, const ColumnChoice& x,
                                                   const ColumnChoice& y);

}  // namespace supple::design
