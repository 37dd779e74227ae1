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
  std::vector<std::string> titles;  ///< for each column as it stands in the file; empty without titles
  std::vector<std::string> names;   ///< the same without units
  std::vector<std::string> units;   ///< for each column, empty where none is named
  std::vector<std::size_t> lines;   ///< indices of the lines that it consists of
  std::string unread;               ///< a line of several words above rows or units that fits no columns; else empty
  std::size_t crowded = 0;          ///< titles of a line that has just half as many as there are columns; else 0
};

/// `above`: the lines between the rows before and the block, in their order. `has_numbers`: for each column.
TableHeader read_header(std::span<const std::string_view> above, TableFormat format,
                        const std::vector<bool>& has_numbers);

/// Whether a line has a title for each column with numbers; the first of these may have none, as an index has.
bool is_titles_line(std::string_view line, TableFormat format, const std::vector<bool>& has_numbers);

struct NameAndUnit {
  std::string name, unit;
};
/// "Strain [%]", "Stress (MPa)", "force/N", "Dehnung in %", "Force_N" and "Load kN" name their unit. In brackets also
/// an unknown one counts; without them only known ones do.
NameAndUnit name_and_unit(std::string_view title);

}  // namespace supple::design
