#include "own_gcode.h"

#include <algorithm>

#include "gcode_words.h"

namespace supple::weave {
namespace {

bool is_decimal(char c) { return c >= '0' && c <= '9'; }

/// Length of a line without its comment.
std::size_t code_length(std::string_view line) { return std::min(line.find(';'), line.size()); }

std::string_view without_line_number(std::string_view line) {
  std::size_t at = line.find_first_not_of(" \t");
  if (at == std::string_view::npos || (line[at] != 'N' && line[at] != 'n')) return line;
  const std::size_t digits = ++at;
  while (at < line.size() && is_decimal(line[at])) ++at;
  if (at == digits) return line;
  at = std::min(line.find_first_not_of(" \t", at), line.size());
  return line.substr(at);
}

/// The line without a checksum such as "*73" at the end of its commands.
std::string without_checksum(std::string_view line) {
  const std::size_t length = code_length(line);
  const std::string_view code = line.substr(0, length);
  const std::size_t star = code.rfind('*');
  if (star == std::string_view::npos || code.substr(0, star).find('"') != std::string_view::npos)
    return std::string(line);
  const std::string_view sum = code.substr(star + 1);
  const auto is_sum = [](char c) { return is_decimal(c) || c == ' ' || c == '\t'; };
  if (sum.empty() || !std::all_of(sum.begin(), sum.end(), is_sum)) return std::string(line);
  return std::string(code.substr(0, star)) + std::string(line.substr(length));
}

/// The first placeholder within a line's commands; empty if there is none. Brackets in quotation marks are text.
std::string_view placeholder_of(std::string_view line) {
  const std::string_view code = line.substr(0, code_length(line));
  bool quoted = false;
  for (std::size_t at = 0; at < code.size(); ++at) {
    if (code[at] == '"') quoted = !quoted;
    if (quoted || (code[at] != '[' && code[at] != '{')) continue;
    const std::size_t end = code.find(code[at] == '[' ? ']' : '}', at);
    return code.substr(at, end == std::string_view::npos ? end : end - at + 1);
  }
  return {};
}

}  // namespace

std::string own_gcode_lines(std::string_view text) {
  std::string result;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::string_view line = next_gcode_line(text, begin);
    const std::string_view plain = without_line_number(line);
    result += plain.size() < line.size() ? without_checksum(plain) : std::string(line);
    result += '\n';
  }
  return result;
}

std::optional<std::string> fault_of_own_gcode(std::string_view text) {
  constexpr std::size_t max_shown_length = 60;
  int number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::string_view line = next_gcode_line(text, begin);
    const std::string where = "line " + std::to_string(++number) + ": ";
    const auto printable = [](char c) { return c == '\t' || (c >= ' ' && c <= '~'); };
    if (!std::all_of(line.begin(), line.end(), printable)) return where + "must be printable ASCII";
    const std::string_view placeholder = placeholder_of(line);
    if (placeholder.empty()) continue;
    return where + "the placeholder " + std::string(placeholder.substr(0, max_shown_length)) +
           " of a slicing program was not replaced; write what the printer is to do";
  }
  return std::nullopt;
}

}  // namespace supple::weave
