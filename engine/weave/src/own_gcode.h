#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace supple::weave {

/// The lines that a printer's owner adds, as they are written into a file. Each ends with a line feed. Line numbers and
/// checksums, which refer to the lines of another file, are removed. Everything else is unchanged. O(length).
std::string own_gcode_lines(std::string_view text);

/// The fault of such lines with the number of the line: bytes that are not printable ASCII, or a placeholder of a
/// slicing program ("[first_layer_temperature]", "{bed_temperature}") outside of comments, which no printer
/// understands. Nothing if there is no fault. O(length).
std::optional<std::string> fault_of_own_gcode(std::string_view text);

}  // namespace supple::weave
