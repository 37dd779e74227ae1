#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/design/profile.h"

namespace supple::design {

/// A table of measurements, as instruments and spreadsheets write it: one block of its rows.
struct MeasuredTable {
  struct Column {
    std::string name;            ///< its title, without the unit; empty without a header
    std::string unit;            ///< as the file writes it: "%", "kPa"; empty where it names none
    std::string title;           ///< name and unit as they stand in the file
    std::vector<double> values;  ///< one for each row; NaN where the cell holds no number
    std::size_t numbers() const;
  };
  std::vector<Column> columns;    ///< at least two, all of the same length
  char delimiter = ',';           ///< between cells: ',', ';', a tab, or ' ' for any number of blanks
  char decimal_separator = '.';   ///< '.' or ','
  std::size_t skipped_lines = 0;  ///< with text that are neither rows nor a header, in the whole file: remarks
  std::size_t odd_lines = 0;      ///< among the rows of the block that do not read like them
  std::size_t block = 0;          ///< index of the block
  std::size_t blocks = 1;         ///< blocks of rows in the file
  std::string unread_titles;      ///< a line of words right above the rows that fits no columns; empty without one
  std::string remarks;            ///< texts before the rows of the block other than its titles, at most 20 kB
  std::size_t rows() const { return columns.empty() ? 0 : columns.front().values.size(); }
};

struct TableOptions {
  std::optional<char> decimal_separator;  ///< '.' or ','; without it all numbers of the file decide
  std::optional<std::size_t> block;       ///< without it the first with a tenth of the rows of the longest one
};

/// Reads comma, semicolon, tab or blank separated numbers with decimal points or commas: of the delimiters the one that
/// finds the most numbers in the first 5000 lines. The decimal separator is the one with which every number of the file
/// can be read; where several can or none, "design.invalid_measurement" is thrown with the place "decimal_separator".
///
/// Rows have the number of cells that most lines with two numbers have, and no words where most of these have numbers.
/// Titles stand before the first row of a block, units in them ("Strain [%]", "stress/MPa", "Force_N", "Load kN"), or
/// in a line of their own. A block ends where titles are repeated, or where another text stands between the rows and a
/// column that only grew begins anew; so does one behind an empty line. Cells may be quoted. `text` is UTF-8.
///
/// Throws "design.unreadable_table" where no line is a row, where decimal commas cannot be told from the separators, or
/// there are more than 1,000,000 rows or 256 columns; "design.invalid_measurement" with the place "block" where there
/// is no such block. O(size of the text).
MeasuredTable read_table(std::string_view text, const TableOptions& options = {},
                         const CancellationToken& cancellation = {});

/// A column by its index or its name (letters of either case); or the one whose name tells what it holds.
using ColumnChoice = std::variant<std::monostate, int, std::string>;

/// The columns of x and y, and what should be known about the choice.
struct ChosenColumns {
  std::size_t x = 0, y = 1;
  std::string note;  ///< a sentence where several columns were as good; empty where there was no choice
};

/// Columns that are not named are found by their titles' words, in several languages, and by their units. For stress
/// over strain: strains before stretches before displacements, and stresses before forces; columns of times, indices,
/// temperatures, rates, transverse strains, true strains and true stresses are never taken unless they are named. Among
/// equally good columns the first one is taken, and for y the first one behind x. Where titles and units tell
/// nothing, a table of two columns has x in the first and y in the second. Throws "design.invalid_measurement" that
/// lists the columns, with the places "columns/x" and "columns/y".
ChosenColumns choose_columns(const MeasuredTable& table, Task task, const ColumnChoice& x, const ColumnChoice& y);

}  // namespace supple::design
