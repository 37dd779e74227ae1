#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace supple::weave {

/// A letter and its number: "X12.5".
struct GcodeWord {
  char letter = ' ';  ///< upper case
  double value = 0;   ///< at most `max_gcode_value` in magnitude
  bool has_value = false;
};
inline constexpr double max_gcode_value = 1e6;

struct GcodeLine {
  std::vector<GcodeWord> words;     ///< no line numbers or checksums; only the first word if text follows
  std::string macro;                ///< name of a macro, such as "START_PRINT"; there are then no words
  std::vector<std::string> faults;  ///< what could not be read, in printable ASCII
};

/// Reads one line, without its end. Comments after ';' and in parentheses, line numbers, checksums and '%' are skipped.
/// Numbers have no exponents: "X1E5" is X1 and E5. If the checker does not use the parameters of a command (a macro, or
/// "M862.3 P "MK3S""), the rest of the line is text and is not read. Accepts any bytes. O(length).
GcodeLine read_gcode_line(std::string_view line);

/// The line of a text that begins at `begin`. Moves `begin` past its end: '\n', "\r\n" or '\r'.
std::string_view next_gcode_line(std::string_view text, std::size_t& begin);

}  // namespace supple::weave
