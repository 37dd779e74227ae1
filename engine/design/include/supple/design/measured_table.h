#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/design/profile.h"

namespace supple::design {

/// One block of rows of a table of measurements, as instruments and spreadsheets write it.
struct MeasuredTable {
  struct Column {
    std::string name;            ///< the title without the unit; empty without a header
    std::string unit;            ///< the unit as the file writes it, e.g. "%" or "kPa"; empty if the file names none
    std::string title;           ///< name and unit as in the file
    std::vector<double> values;  ///< one for each row; NaN if the cell has no number
    std::size_t number_count() const;
  };
  std::vector<Column> columns;      ///< at least two, all of the same length
  char delimiter = ',';             ///< separator of cells: ',', ';', a tab, or ' ' for any number of blanks
  char decimal_separator = '.';     ///< '.' or ','
  std::size_t skipped_lines = 0;    ///< lines of text in the whole file that are neither rows nor a header
  std::size_t malformed_lines = 0;  ///< lines with numbers among the block's rows that do not have the form of a row
  std::size_t block = 0;            ///< index of this block in the file
  std::size_t blocks = 1;           ///< number of blocks in the file
  /// A line of words directly above the rows that cannot be assigned to columns; empty without one.
  std::string unmatched_titles;
  std::string remarks;  ///< text before the rows of the block, without its titles; at most 20 kB
  std::size_t rows() const { return columns.empty() ? 0 : columns.front().values.size(); }
};

struct TableOptions {
  std::optional<char> decimal_separator;  ///< '.' or ','; without it all numbers of the file decide
  /// Index of the block; without it the first one that has at least a tenth of the longest block's rows.
  std::optional<std::size_t> block;
};

/// Reads numbers that are separated by commas, semicolons, tabs or blanks. The delimiter is the one that gives the most
/// numbers in the first 5000 lines. The decimal separator is the one with which every number of the file can be read.
/// If both give different numbers, or if neither can read all of them, "design.invalid_measurement" is thrown with the
/// place "decimal_separator".
///
/// Rows have the number of cells that most lines with two numbers have. They have no words in columns where most of
/// these lines have numbers. Titles stand before the first row of a block; units stand in them ("Strain [%]",
/// "stress/MPa", "Force_N", "Load kN") or in a line of their own. A block ends where titles are repeated. It also ends
/// at an empty line or another text between the rows if a column that only increased starts again from a smaller value.
/// Cells may be quoted. `text` is UTF-8.
///
/// Throws "design.unreadable_table" if no line is a row, if decimal commas cannot be told from the separators, or if
/// there are more than 1,000,000 rows or 256 columns. Throws "design.invalid_measurement" with the place "block" if
/// there is no such block. O(size of the text).
MeasuredTable read_table(std::string_view text, const TableOptions& options = {},
                         const CancellationToken& cancellation = {});

/// A column by its index or its name (upper and lower case are the same), or none: then it is found by its title and
/// unit.
using ColumnChoice = std::variant<std::monostate, int, std::string>;

/// The columns of x and y.
struct ChosenColumns {
  std::size_t x = 0, y = 1;
  std::string note;  ///< a sentence if other columns would have fitted as well; empty otherwise
};

/// Finds the columns that are not given by the words of their titles, in several languages, and by their units. For
/// stress over strain, x is preferably a strain, then a stretch, then a displacement; y is preferably a stress, then a
/// force. Times, indices, temperatures, rates, transverse strains, true strains and true stresses are taken only if the
/// caller names them. Among equally good columns the first is taken, and for y the first one after x. If titles and
/// units tell nothing, a table of two columns has x in the first and y in the second. Throws
/// "design.invalid_measurement" that lists the columns, with the places "columns/x" and "columns/y".
ChosenColumns choose_columns(const MeasuredTable& table, Task task, const ColumnChoice& x, const ColumnChoice& y);

}  // namespace supple::design
