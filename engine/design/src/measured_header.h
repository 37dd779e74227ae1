#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "measured_shapes.h"

// The titles and units above a block of rows.
namespace supple::design {

struct TableHeader {
  std::vector<std::string> titles;  ///< title of each column as in the file; empty without titles
  std::vector<std::string> names;   ///< titles without their units
  std::vector<std::string> units;   ///< unit of each column; empty if none is named
  std::vector<std::size_t> lines;   ///< indices of the lines that hold titles and units
  /// A line of several words above the rows or units that cannot be assigned to columns; empty without one.
  std::string unmatched;
  /// Number of titles in a line that has exactly half as many titles as there are columns; 0 without such a line.
  std::size_t half_title_count = 0;
};

/// Finds titles and units. `above` are the lines between the previous block and this one, in their order. `has_numbers`
/// has one entry for each column.
TableHeader read_header(std::span<const std::string_view> above, TableFormat format,
                        const std::vector<bool>& has_numbers);

/// Whether a line has a title for each column with numbers. The first of these columns may have none, because it may be
/// an index.
bool is_titles_line(std::string_view line, TableFormat format, const std::vector<bool>& has_numbers);

struct NameAndUnit {
  std::string name, unit;
};
/// Splits a title into name and unit: "Strain [%]", "Stress (MPa)", "force/N", "Dehnung in %", "Force_N", "Load kN". In
/// brackets an unknown unit counts too; without brackets only known units do.
NameAndUnit name_and_unit(std::string_view title);

}  // namespace supple::design
