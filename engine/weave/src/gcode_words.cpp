#include "gcode_words.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <system_error>
#include <utility>

namespace supple::weave {
namespace {

constexpr std::size_t max_words = 32;
constexpr std::size_t max_faults = 4;
/// Maximum number of bytes of a line that are read. Printers accept some hundred.
constexpr std::size_t max_line_length = 1 << 16;

/// Maximum length of a macro's name in a report.
constexpr std::size_t max_macro_length = 60;

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

/// Whether the checker uses the parameters of a command. All other commands may be followed by any text.
bool has_words(const GcodeWord& command) {
  constexpr std::array general{0.0, 1.0, 4.0, 20.0, 21.0, 28.0, 90.0, 91.0, 92.0};
  constexpr std::array machine{18.0, 82.0, 83.0, 84.0, 104.0, 106.0, 107.0, 109.0, 140.0, 190.0, 200.0, 220.0, 221.0};
  if (!command.has_value || command.letter == 'T') return true;
  if (command.letter == 'G') return std::find(general.begin(), general.end(), command.value) != general.end();
  if (command.letter == 'M') return std::find(machine.begin(), machine.end(), command.value) != machine.end();
  return true;
}

std::string display_text(char c) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), c > ' ' && c <= '~' ? "'%c'" : "byte 0x%02x", static_cast<unsigned char>(c));
  return text.data();
}

class LineReader {
 public:
  explicit LineReader(std::string_view line) : line_(line) {}

  GcodeLine read() {
    while (at_ < line_.size()) {
      const char c = line_[at_];
      if (c == ';') break;
      if (c == ' ' || c == '\t' || c == '%') {
        ++at_;
      } else if (c == '(') {
        const std::size_t end = line_.find(')', at_);
        at_ = end == std::string_view::npos ? line_.size() : end + 1;
      } else if (c == '*') {
        checksum();
      } else if (result_.words.empty() && begins_macro()) {
        macro();
        break;
      } else if (is_letter(c)) {
        word();
        if (result_.words.size() == 1 && !has_words(result_.words.front())) break;
      } else {
        fault("unexpected " + display_text(c));
        ++at_;
      }
    }
    return std::move(result_);
  }

 private:
  void fault(const std::string& message) {
    if (result_.faults.size() < max_faults) result_.faults.push_back(message);
  }

  void checksum() {
    std::size_t digits = 0;
    for (++at_; at_ < line_.size() && is_digit(line_[at_]); ++at_) ++digits;
    if (digits == 0 || digits > 3) fault("a checksum must have one to three digits");
  }

  /// Whether a name of two or more letters begins here. A command has one letter, and a number after it.
  bool begins_macro() const {
    const auto at = [this](std::size_t k) { return k < line_.size() ? line_[k] : ' '; };
    return (is_letter(at(at_)) || at(at_) == '_') && (is_letter(at(at_ + 1)) || at(at_ + 1) == '_');
  }
  void macro() {
    std::size_t end = at_;
    while (end < line_.size() && (is_letter(line_[end]) || is_digit(line_[end]) || line_[end] == '_')) ++end;
    result_.macro = std::string(line_.substr(at_, std::min(end - at_, max_macro_length)));
  }

  void word() {
    GcodeWord word{upper(line_[at_++])};
    std::size_t begin = at_;
    const bool negative = begin < line_.size() && line_[begin] == '-';
    if (negative || (begin < line_.size() && line_[begin] == '+')) ++begin;
    // Only digits and points go to the library, which would also accept "inf" and "nan".
    std::size_t end = begin;
    while (end < line_.size() && (is_digit(line_[end]) || line_[end] == '.')) ++end;
    const std::string_view digits = line_.substr(begin, end - begin);
    word.has_value = end > at_;
    at_ = end;
    if (word.has_value) {
      const auto read =
          std::from_chars(digits.data(), digits.data() + digits.size(), word.value, std::chars_format::fixed);
      if (read.ec == std::errc::invalid_argument || read.ptr != digits.data() + digits.size()) {
        fault(std::string(1, word.letter) + " is followed by something that is not a number");
        return;
      }
      if (read.ec != std::errc() || !(word.value <= max_gcode_value)) {
        fault(std::string(1, word.letter) + " is out of range");
        return;
      }
      if (negative) word.value = -word.value;
    }
    if (word.letter == 'N' && result_.words.empty()) {
      if (!word.has_value || word.value != std::floor(word.value)) fault("a line number must be a whole number");
      return;
    }
    if (result_.words.size() < max_words)
      result_.words.push_back(word);
    else
      fault("more than " + std::to_string(max_words) + " words");
  }

  std::string_view line_;
  std::size_t at_ = 0;
  GcodeLine result_;
};

}  // namespace

GcodeLine read_gcode_line(std::string_view line) {
  const std::string_view read = line.substr(0, max_line_length);
  GcodeLine result = LineReader(read).read();
  if (line.size() > max_line_length && read.find(';') == std::string_view::npos)
    result.faults.push_back("a line of " + std::to_string(line.size()) + " bytes, of which " +
                            std::to_string(max_line_length) + " were read");
  return result;
}

std::string_view next_gcode_line(std::string_view text, std::size_t& begin) {
  const std::size_t end = text.find_first_of("\r\n", begin);
  const std::string_view line = text.substr(begin, end == std::string_view::npos ? end : end - begin);
  if (end == std::string_view::npos) {
    begin = text.size();
  } else {
    begin = end + (text.substr(end, 2) == "\r\n" ? 2 : 1);
  }
  return line;
}

}  // namespace supple::weave
