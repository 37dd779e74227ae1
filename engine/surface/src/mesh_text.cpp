#include "mesh_text.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>

#include "supple/base/error.h"
#include "supple/surface/mesh_error.h"

namespace supple::surface {
namespace {

[[noreturn]] void throw_malformed(std::string where, const std::string& message) {
  throw MalformedMesh("mesh.malformed", "The mesh file is malformed at " + where + ": " + message + ".",
                      {{where, message}});
}

// std::from_chars accepts no leading plus, but files may have one.
std::string_view without_plus(std::string_view token) {
  if (token.size() > 1 && token[0] == '+' && token[1] != '-') token.remove_prefix(1);
  return token;
}

/// The value of a number that is not finite as Microsoft's C library writes it: "1.#INF", "-1.#IND", "1.#QNAN",
/// "1.#SNAN", or "1.#J" if these were rounded. Empty for any other word.
std::optional<double> microsoft_non_finite(std::string_view digits) {
  if (!digits.empty() && digits[0] == '-') digits.remove_prefix(1);
  if (!digits.starts_with("1.#")) return std::nullopt;
  digits.remove_prefix(3);
  while (digits.ends_with('0')) digits.remove_suffix(1);
  if (digits == "INF") return std::numeric_limits<double>::infinity();
  for (const std::string_view name : {"IND", "QNAN", "SNAN", "J", "IO", "R", "QO", "S"})
    if (digits == name) return std::numeric_limits<double>::quiet_NaN();
  return std::nullopt;
}

/// A hint for an error message, if the token would be a number with a point instead of its comma.
std::string decimal_comma_hint(std::string_view token) {
  std::string with_point(token);
  const std::size_t comma = with_point.find(',');
  if (comma == std::string::npos) return {};
  with_point[comma] = '.';
  double value = 0;
  const char* const last = with_point.data() + with_point.size();
  const auto [end, error] = std::from_chars(with_point.data(), last, value);
  return error == std::errc() && end == last ? "; decimals take a point, not a comma" : "";
}

/// Maximum number of characters: reading a number of a hundred million digits takes seconds.
constexpr std::size_t max_number_length = 1 << 16;

}  // namespace

void throw_malformed_line(std::int64_t line, const std::string& message) {
  throw_malformed("line " + std::to_string(line), message);
}

void throw_malformed_byte(std::size_t offset, const std::string& message) {
  throw_malformed("byte " + std::to_string(offset), message);
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t max_length = 24;
  if (text.empty()) return "nothing";
  std::string result = "'";
  for (const char c : text.substr(0, max_length)) result += c >= ' ' && c <= '~' ? c : '?';
  return result + (text.size() > max_length ? "...'" : "'");
}

std::string_view without_byte_order_mark(std::string_view bytes) {
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  return bytes;
}

std::string_view TextScanner::token_across_lines() {
  for (;;) {
    if (const std::string_view found = token(); !found.empty()) return found;
    if (!next_line()) return {};
  }
}

void TextScanner::cut_comment_at(std::size_t mark) {
  for (; mark != std::string_view::npos; mark = line_.find('#', mark + 1)) {
    const bool in_number = mark >= 2 && line_.substr(mark - 2, 2) == "1." && mark + 1 < line_.size() &&
                           line_[mark + 1] >= 'A' && line_[mark + 1] <= 'Z';
    if (in_number) continue;
    line_ = line_.substr(0, mark);
    return;
  }
}

std::string_view TextScanner::continued_token() {
  continues_ = false;
  if (!next_line()) return {};
  cut_comment();
  return statement_token();
}

std::string_view TextScanner::token_before_backslash(std::string_view found) {
  if (!std::all_of(line_.begin(), line_.end(), is_blank)) return found;
  continues_ = true;
  found.remove_suffix(1);
  return found.empty() ? continued_token() : found;
}

void TextScanner::skip_statement() {
  const auto continues = [this] {
    std::string_view line = line_;
    while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
    return line.ends_with('\\');
  };
  while (continues() && next_line()) {
  }
}

double TextScanner::number(std::string_view token, std::string_view what) const {
  if (token.size() > max_number_length) {
    throw_malformed_line(line_number_, in_quotes(token) + " has " + std::to_string(token.size()) +
                                           " characters; a number has at most " + std::to_string(max_number_length));
  }
  const std::string_view digits = without_plus(token);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range) {
    throw_malformed_line(line_number_, in_quotes(token) + " is beyond the range of double precision");
  }
  if (error == std::errc() && end == digits.data() + digits.size()) return value;
  if (const auto non_finite = microsoft_non_finite(digits)) return *non_finite;
  throw_malformed_line(line_number_,
                       "expected " + std::string(what) + ", found " + in_quotes(token) + decimal_comma_hint(token));
}

std::int64_t TextScanner::any_integer(std::string_view token, std::string_view what) const {
  const std::string_view digits = without_plus(token);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size()) {
    throw_malformed_line(line_number_, "expected " + std::string(what) + ", found " + in_quotes(token));
  }
  return value;
}

}  // namespace supple::surface
