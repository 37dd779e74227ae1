#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace supple::weave {

/// A letter and its number: "X12.5".
struct GcodeWord {
  char letter = ' ';  ///< upper case
  double value = 0;   ///< at most largest_gcode_value in absolute value
  bool has_value = false;
};
inline constexpr double largest_gcode_value = 1e6;

struct GcodeLine {
  std::vector<GcodeWord> words;     ///< without line numbers and checksums
  std::vector<std::string> faults;  ///< what could not be read, printable ASCII
};

/// Reads one line, without its end: comments after ';' and in parentheses, line numbers, checksums and '%' are skipped.
/// Numbers have no exponents: "X1E5" is X1 and E5. Any bytes are fine. O(length).
GcodeLine read_gcode_line(std::string_view line);

/// The next line of a text from `begin` on, which moves behind its end: '\n', "\r\n" or '\r'.
std::string_view next_gcode_line(std::string_view text, std::size_t& begin);

}  // namespace supple::weave
