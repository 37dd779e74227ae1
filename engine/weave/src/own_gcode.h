#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace supple::weave {

/// The lines that a printer's owner adds, as they are written into a file: each ends with a line feed, and line numbers
/// and checksums, which count the lines of another file, are taken away. All else is passed on as it is. O(length).
std::string own_gcode_lines(std::string_view text);

/// What is wrong with such lines, with the number of the line: bytes that are not printable ASCII, or a placeholder of
/// a slicing program ("[first_layer_temperature]", "{bed_temperature}") outside of comments, which no printer knows.
/// None if they can be passed on. O(length).
std::optional<std::string> fault_of_own_gcode(std::string_view text);

}  // namespace supple::weave
