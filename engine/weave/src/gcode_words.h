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
  std::vector<GcodeWord> words;     ///< without line numbers and checksums; of a text command the first word alone
  std::string macro;                ///< name of a macro, "START_PRINT", in which case there are no words
  std::vector<std::string> faults;  ///< what could not be read, printable ASCII
};

/// Reads one line, without its end: comments after ';' and in parentheses, line numbers, checksums and '%' are skipped.
/// Numbers have no exponents: "X1E5" is X1 and E5. What follows a command whose parameters the checker does not use (a
/// macro, or "M862.3 P "MK3S"") is text and is not read. Any bytes are fine. O(length).
GcodeLine read_gcode_line(std::string_view line);

/// The next line of a text from `begin` on, which moves behind its end: '\n', "\r\n" or '\r'.
std::string_view next_gcode_line(std::string_view text, std::size_t& begin);

}  // namespace supple::weave
