#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace supple::surface {

/// Throws "mesh.malformed" at "line <line>" or "byte <offset>".
[[noreturn]] void throw_malformed_line(std::int64_t line, const std::string& message);
[[noreturn]] void throw_malformed_byte(std::size_t offset, const std::string& message);
/// The text in quotes for a message: it is shortened, and everything but printable ASCII is replaced.
std::string in_quotes(std::string_view text);
std::string_view without_byte_order_mark(std::string_view bytes);

/// Finds a character in a text, from its beginning to its end. It searches many lines at once, so that each line
/// without the character costs one comparison.
class CharacterFinder {
 public:
  explicit CharacterFinder(char character) : character_(character) {}

  /// The first position of the character in [begin, end), or `end`. `begin` must not decrease from call to call.
  std::size_t first_in(std::string_view text, std::size_t begin, std::size_t end) {
    return position_ >= end ? end : search(text, begin, end);
  }

 private:
  std::size_t search(std::string_view text, std::size_t begin, std::size_t end) {
    constexpr std::size_t min_searched = 1 << 14;
    if (found_ && position_ >= begin) return position_;
    const std::size_t from = std::max(position_, begin);
    const std::size_t to = std::min(text.size(), std::max(end, from + min_searched));
    const void* const found = std::memchr(text.data() + from, character_, to - from);
    found_ = found != nullptr;
    position_ = found_ ? static_cast<std::size_t>(static_cast<const char*>(found) - text.data()) : to;
    return std::min(position_, end);
  }

  char character_;
  std::size_t position_ = 0;  ///< the character is here if found_; between the last `begin` and here it does not occur
  bool found_ = false;
};

/// Steps through the lines and the blank-separated tokens of a text. Lines end with LF, CR or CR LF.
class TextScanner {
 public:
  /// `lines_before` lines precede the text in its file, and count in line_number.
  explicit TextScanner(std::string_view text, std::int64_t lines_before = 0)
      : text_(text), line_number_(lines_before) {}

  /// Moves to the next line. Returns false at the end of the text.
  bool next_line() {
    continues_ = false;
    if (next_ >= text_.size()) {
      line_ = {};
      return false;
    }
    const std::size_t feed = line_feeds_.first_in(text_, next_, text_.size());
    const std::size_t end = carriage_returns_.first_in(text_, next_, feed);
    line_ = text_.substr(next_, end - next_);
    // A line feed directly after a carriage return belongs to it.
    next_ = (end + 1 == feed ? feed : end) + 1;
    ++line_number_;
    return true;
  }
  /// The next token of the current line; empty at its end.
  std::string_view token() {
    const char *first = line_.data(), *const end = first + line_.size();
    while (first != end && is_blank(*first)) ++first;
    const char* last = first;
    while (last != end && !is_blank(*last)) ++last;
    line_ = {last, static_cast<std::size_t>(end - last)};
    return {first, static_cast<std::size_t>(last - first)};
  }
  /// The next token of this line or the following ones; empty at the end of the text.
  std::string_view token_across_lines();
  /// Cuts a comment, which begins with "#", from the rest of the current line. The "#" of "-1.#IND" begins no comment:
  /// Microsoft's C library writes numbers that are not finite in this form.
  void cut_comment() {
    if (line_.empty()) return;
    const auto begin = static_cast<std::size_t>(line_.data() - text_.data());
    const std::size_t end = begin + line_.size();
    if (const std::size_t mark = comment_marks_.first_in(text_, begin, end); mark < end) cut_comment_at(mark - begin);
  }
  /// The next token of a statement; empty at its end. A backslash at the end of a line continues the statement on the
  /// next one.
  std::string_view statement_token() {
    if (continues_) return continued_token();
    const std::string_view found = token();
    return found.empty() || found.back() != '\\' ? found : token_before_backslash(found);
  }
  /// Skips the lines on which the current statement continues.
  void skip_statement();

  std::int64_t line_number() const { return line_number_; }
  /// The text after the current line.
  std::string_view rest() const { return text_.substr(std::min(next_, text_.size())); }

  /// The token as a number. "nan", "inf", "nan(ind)", "-1.#IND", "1.#QNAN" and "1.#INF" are accepted as numbers that
  /// are not finite. The check of the mesh then names their vertex.
  double number(std::string_view token, std::string_view what) const;
  std::int64_t integer(std::string_view token, std::string_view what) const {
    constexpr std::size_t max_plain_length = 18;  // that many digits always fit into an integer of 64 bits
    if (token.empty() || token.size() > max_plain_length) return any_integer(token, what);
    std::int64_t value = 0;
    for (const char c : token) {
      if (c < '0' || c > '9') return any_integer(token, what);
      value = 10 * value + (c - '0');
    }
    return value;
  }
  /// Throws as `number` does if the token is not a number.
  void check_number(std::string_view token, std::string_view what) const {
    if (!is_plain_decimal(token)) number(token, what);
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
  /// Whether the token consists of digits with at most one point and a sign, and is certainly in the range of double
  /// precision.
  static bool is_plain_decimal(std::string_view token) {
    constexpr std::size_t max_plain_length = 100;
    if (token.starts_with('-')) token.remove_prefix(1);
    std::size_t digits = 0, points = 0;
    for (const char c : token) {
      digits += static_cast<std::size_t>(c >= '0' && c <= '9');
      points += static_cast<std::size_t>(c == '.');
    }
    return digits > 0 && points <= 1 && digits + points == token.size() && token.size() <= max_plain_length;
  }
  std::int64_t any_integer(std::string_view token, std::string_view what) const;
  void cut_comment_at(std::size_t mark);
  std::string_view continued_token();
  std::string_view token_before_backslash(std::string_view found);

  std::string_view text_;
  std::size_t next_ = 0;  ///< index into text_ of the next line
  CharacterFinder line_feeds_{'\n'}, carriage_returns_{'\r'}, comment_marks_{'#'};
  std::int64_t line_number_;
  std::string_view line_;
  bool continues_ = false;  ///< whether statement_token has read the backslash at the end of the current line
};

}  // namespace supple::surface
