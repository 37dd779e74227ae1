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
/// The text in quotes, shortened, with everything but printable ASCII replaced: fit for a message whatever it is.
std::string in_quotes(std::string_view text);
std::string_view without_byte_order_mark(std::string_view bytes);

/// Finds the places of a character in a text from its beginning to its end. It looks ahead over many lines at once, so
/// that lines without the character cost one comparison.
class PlaceFinder {
 public:
  explicit PlaceFinder(char sought) : sought_(sought) {}

  /// The first place of the character in [begin, end), or `end`; `begin` must not decrease from call to call.
  std::size_t first_in(std::string_view text, std::size_t begin, std::size_t end) {
    return known_ >= end ? end : search(text, begin, end);
  }

 private:
  std::size_t search(std::string_view text, std::size_t begin, std::size_t end) {
    constexpr std::size_t look_ahead = 1 << 14;
    if (is_place_ && known_ >= begin) return known_;
    const std::size_t from = std::max(known_, begin);
    const std::size_t to = std::min(text.size(), std::max(end, from + look_ahead));
    const void* const found = std::memchr(text.data() + from, sought_, to - from);
    is_place_ = found != nullptr;
    known_ = is_place_ ? static_cast<std::size_t>(static_cast<const char*>(found) - text.data()) : to;
    return std::min(known_, end);
  }

  char sought_;
  std::size_t known_ =
      0;  ///< the character is at this place if is_place_, and at none before it that is still asked for
  bool is_place_ = false;
};

/// Steps through the lines and the blank-separated tokens of a text. Lines end with LF, CR or CR LF.
class TextScanner {
 public:
  /// `lines_before` precede the text in its file and count in line_number.
  explicit TextScanner(std::string_view text, std::int64_t lines_before = 0)
      : text_(text), line_number_(lines_before) {}

  /// Moves to the next line; false at the end of the text.
  bool next_line() {
    continues_ = false;
    if (next_ >= text_.size()) {
      line_ = {};
      return false;
    }
    const std::size_t feed = feeds_.first_in(text_, next_, text_.size());
    const std::size_t end = returns_.first_in(text_, next_, feed);
    line_ = text_.substr(next_, end - next_);
    // A line feed right after a return belongs to it.
    next_ = (end + 1 == feed ? feed : end) + 1;
    ++line_number_;
    return true;
  }
  /// The next token of the current line, empty at its end.
  std::string_view token() {
    const char *first = line_.data(), *const end = first + line_.size();
    while (first != end && is_blank(*first)) ++first;
    const char* last = first;
    while (last != end && !is_blank(*last)) ++last;
    line_ = {last, static_cast<std::size_t>(end - last)};
    return {first, static_cast<std::size_t>(last - first)};
  }
  /// The next token of this line or those that follow, empty at the end of the text.
  std::string_view token_across_lines();
  /// Drops the comment that "#" begins in what remains of the current line. The "#" of "-1.#IND" begins none: by such
  /// words the C library of Microsoft writes numbers that are not finite.
  void cut_comment() {
    if (line_.empty()) return;
    const auto begin = static_cast<std::size_t>(line_.data() - text_.data());
    const std::size_t end = begin + line_.size();
    if (const std::size_t mark = marks_.first_in(text_, begin, end); mark < end) cut_comment_at(mark - begin);
  }
  /// The next token of a statement that goes on in the next line where a line ends with a backslash; empty at its end.
  std::string_view statement_token() {
    if (continues_) return continued_token();
    const std::string_view found = token();
    return found.empty() || found.back() != '\\' ? found : token_before_backslash(found);
  }
  /// Skips the lines into which the current statement goes on.
  void skip_statement();

  std::int64_t line_number() const { return line_number_; }
  /// What follows the current line.
  std::string_view rest() const { return text_.substr(std::min(next_, text_.size())); }

  /// The token as a number. "nan", "inf", "nan(ind)", "-1.#IND", "1.#QNAN" and "1.#INF" are numbers that are not
  /// finite: the mesh check names the vertex that has them.
  double number(std::string_view token, std::string_view what) const;
  std::int64_t integer(std::string_view token, std::string_view what) const {
    constexpr std::size_t longest_plain = 18;  // digits that fit into an integer of 64 bits whatever they are
    if (token.empty() || token.size() > longest_plain) return any_integer(token, what);
    std::int64_t value = 0;
    for (const char c : token) {
      if (c < '0' || c > '9') return any_integer(token, what);
      value = 10 * value + (c - '0');
    }
    return value;
  }
  /// Throws as `number` does if the token is none.
  void check_number(std::string_view token, std::string_view what) const {
    if (!is_plain_decimal(token)) number(token, what);
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
  /// Whether the token is digits with at most one point and a sign, and surely within the range of double precision.
  static bool is_plain_decimal(std::string_view token) {
    constexpr std::size_t longest_plain = 100;
    if (token.starts_with('-')) token.remove_prefix(1);
    std::size_t digits = 0, points = 0;
    for (const char c : token) {
      digits += static_cast<std::size_t>(c >= '0' && c <= '9');
      points += static_cast<std::size_t>(c == '.');
    }
    return digits > 0 && points <= 1 && digits + points == token.size() && token.size() <= longest_plain;
  }
  std::int64_t any_integer(std::string_view token, std::string_view what) const;
  void cut_comment_at(std::size_t mark);
  std::string_view continued_token();
  std::string_view token_before_backslash(std::string_view found);

  std::string_view text_;
  std::size_t next_ = 0;  ///< where the next line begins
  PlaceFinder feeds_{'\n'}, returns_{'\r'}, marks_{'#'};
  std::int64_t line_number_;
  std::string_view line_;
  bool continues_ = false;  ///< whether statement_token has met the backslash at the end of the current line
};

}  // namespace supple::surface
