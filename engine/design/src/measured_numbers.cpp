#include "measured_numbers.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <utility>

#include "supple/design/measured_text.h"

namespace supple::design {
namespace {

constexpr std::size_t max_number_bytes = 64;
constexpr std::size_t digits_in_group = 3;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

constexpr std::array<std::pair<std::string_view, char>, 18> plain_characters{{
    {"\xE2\x88\x92", '-'},  // minus sign
    {"\xE2\x80\x92", '-'},  // figure dash
    {"\xE2\x80\x93", '-'},  // en dash
    {"\xEF\xB9\xA3", '-'},  // small hyphen-minus
    {"\xEF\xBC\x8D", '-'},  // full-width hyphen-minus
    {"\xE2\x80\x90", '-'},  // hyphen
    {"\xE2\x80\x91", '-'},  // non-breaking hyphen
    {"\xEF\xBC\x8B", '+'},  // full-width plus
    {"\xEF\xBC\x8E", '.'},  // full-width full stop
    {"\xEF\xBC\x8C", ','},  // full-width comma
    {"\xEF\xBC\x85", '%'},  // full-width per cent
    {"\xC2\xA0", '_'},      // no-break space
    {"\xE2\x80\xAF", '_'},  // narrow no-break space
    {"\xE2\x80\x89", '_'},  // thin space
    {"\xE2\x80\x87", '_'},  // figure space
    {"\xE2\x80\x99", '\''},
    {"\xC2\xB4", '\''},
    {"\xE3\x80\x80", '_'},  // ideographic space
}};

/// The cell in plain characters, with "_" for non-breaking blanks. Empty if the cell is too long or has other
/// characters.
std::string as_plain_text(std::string_view cell) {
  std::string out;
  for (std::size_t i = 0; i < cell.size() && out.size() <= max_number_bytes;) {
    if (static_cast<unsigned char>(cell[i]) < 0x80) {
      if (cell[i] == '_') return {};
      out += cell[i++];
      continue;
    }
    const std::string_view rest = cell.substr(i);
    const auto* const character = std::find_if(plain_characters.begin(), plain_characters.end(),
                                               [&](const auto& pair) { return rest.starts_with(pair.first); });
    if (character != plain_characters.end()) {
      out += character->second;
      i += character->first.size();
    } else if (rest.size() > 2 && rest.starts_with("\xEF\xBC") && rest[2] >= '\x90' && rest[2] <= '\x99') {
      out += static_cast<char>('0' + (rest[2] - '\x90'));  // full-width digit
      i += 3;
    } else {
      return {};
    }
  }
  while (out.ends_with('_') || out.ends_with(' ')) out.pop_back();
  const auto begin = out.find_first_not_of("_ ");
  if (begin == std::string::npos || out.size() > max_number_bytes) return {};
  return out.substr(begin);
}

/// Parses a number of plain characters from the beginning on.
class NumberReader {
 public:
  NumberReader(std::string_view text, char decimal, bool blank_thousands)
      : text_(text), decimal_(decimal), blank_thousands_(blank_thousands) {}

  std::optional<WrittenNumber> read() {
    sign();
    if (!integer_part()) return std::nullopt;
    if (!fraction()) return std::nullopt;
    if (!exponent()) return std::nullopt;
    WrittenNumber number;
    std::size_t end = at_;
    while (end < text_.size() && (text_[end] == ' ' || text_[end] == '_')) ++end;
    if (end < text_.size() && text_[end] == '%') {
      number.has_percent = true;
      at_ = end + 1;
    }
    if (at_ != text_.size()) return std::nullopt;
    const auto [stop, error] = std::from_chars(digits_.data(), digits_.data() + digits_.size(), number.value);
    if (error != std::errc() || stop != digits_.data() + digits_.size() || !std::isfinite(number.value))
      return std::nullopt;
    return number;
  }

 private:
  char current() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  char next() const { return at_ + 1 < text_.size() ? text_[at_ + 1] : '\0'; }

  void sign() {
    if (current() == '-') digits_ += '-';
    if (current() == '-' || current() == '+') ++at_;
    if (current() == ' ' || current() == '_') ++at_;
  }

  bool separates_groups(char c) const {
    return c == '_' || c == '\'' || (c == ' ' && blank_thousands_) || (c == (decimal_ == '.' ? ',' : '.'));
  }

  bool integer_part() {
    const std::size_t begin = at_;
    while (is_digit(current())) digits_ += text_[at_++];
    const std::size_t first_group = at_ - begin;
    whole_digits_ = first_group;
    const char separator = current();
    if (first_group == 0 || !separates_groups(separator) || !is_digit(next())) return true;
    // A group of thousands has three digits. Only the first group may be shorter, and it does not begin with zero.
    if (first_group > digits_in_group || text_[begin] == '0') return false;
    while (current() == separator && is_digit(next())) {
      ++at_;
      std::size_t count = 0;
      for (; is_digit(current()); ++count) digits_ += text_[at_++];
      if (count != digits_in_group) return false;
    }
    return true;
  }

  bool fraction() {
    if (current() != decimal_) return whole_digits_ > 0;
    ++at_;
    digits_ += '.';
    std::size_t count = 0;
    for (; is_digit(current()); ++count) digits_ += text_[at_++];
    if (count == 0 && decimal_ == ',') return false;
    if (count == 0) digits_ += '0';
    return count > 0 || whole_digits_ > 0;
  }

  bool exponent() {
    if (current() != 'e' && current() != 'E') return true;
    ++at_;
    digits_ += 'e';
    if (current() == '-') digits_ += '-';
    if (current() == '-' || current() == '+') ++at_;
    std::size_t count = 0;
    for (; is_digit(current()); ++count) digits_ += text_[at_++];
    return count > 0;
  }

  std::string_view text_;
  char decimal_;
  bool blank_thousands_;
  std::size_t at_ = 0;
  std::size_t whole_digits_ = 0;
  std::string digits_;
};

}  // namespace

std::optional<WrittenNumber> number_in(std::string_view cell, char decimal, bool blank_thousands) {
  if (cell.empty() || cell.size() > 3 * max_number_bytes) return std::nullopt;
  // Fast path for plain numbers with decimal points, which most cells are.
  if (decimal == '.' && (is_digit(cell.front()) || cell.front() == '-') && is_digit(cell.back())) {
    double value = 0;
    const auto [stop, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error == std::errc() && stop == cell.data() + cell.size() && std::isfinite(value))
      return WrittenNumber{value, false};
  }
  const bool is_plain = std::all_of(cell.begin(), cell.end(), [](char c) { return c > ' ' && c < '\x7F' && c != '_'; });
  if (is_plain && cell.size() <= max_number_bytes) return NumberReader(cell, decimal, blank_thousands).read();
  const std::string text = as_plain_text(cell);
  return text.empty() ? std::nullopt : NumberReader(text, decimal, blank_thousands).read();
}

DecimalEvidence decimal_evidence(std::string_view cell, bool blank_thousands) {
  // Without a point and a comma, and without their full-width forms, the number is the same with both separators.
  if (cell.find_first_of(".,") == std::string_view::npos && cell.find('\xEF') == std::string_view::npos)
    return DecimalEvidence::none;
  const auto point = number_in(cell, '.', blank_thousands);
  const auto comma = number_in(cell, ',', blank_thousands);
  if (!point && !comma) return DecimalEvidence::none;
  if (!comma) return DecimalEvidence::point;
  if (!point) return DecimalEvidence::comma;
  return point->value == comma->value ? DecimalEvidence::none : DecimalEvidence::ambiguous;
}

bool is_missing_mark(std::string_view cell) {
  constexpr std::array<std::string_view, 24> marks{"nan",    "-nan",  "+nan",     "inf",       "-inf",    "+inf",
                                                   "-",      "--",    "---",      "n/a",       "#n/a",    "na",
                                                   "null",   "none",  "nan(ind)", "#div/0!",   "#value!", "#num!",
                                                   "#wert!", "#ref!", "infinity", "-infinity", "*",       "****"};
  constexpr std::size_t longest = 12;
  if (cell.size() > longest) return false;
  const std::string lower = lower_case(cell);
  return std::find(marks.begin(), marks.end(), lower) != marks.end();
}

}  // namespace supple::design
