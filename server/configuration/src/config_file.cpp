#include "supple/configuration/config_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <sstream>
#include <stdexcept>

namespace supple::configuration {
namespace {

bool is_space(char letter) { return letter == ' ' || letter == '\t' || letter == '\r'; }

bool is_key_character(char letter) {
  return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') || (letter >= '0' && letter <= '9') ||
         letter == '-' || letter == '_';
}

/// Whether the text needs no quotes in TOML: it is a number, true or false.
bool is_bare_value(const std::string& text) {
  if (text == "true" || text == "false") return true;
  if (text.empty()) return false;
  std::istringstream number(text);
  double value = 0;
  number >> value;
  return !number.fail() && number.peek() == std::istringstream::traits_type::eof();
}

/// Parses one line. Throws std::runtime_error, which says what is wrong with the line.
class Line {
 public:
  explicit Line(std::string_view text) : text_(text) {}

  /// The setting of the line; nothing for an empty line or a comment.
  std::optional<Setting> setting() {
    skip_spaces();
    if (at_end()) return std::nullopt;
    if (peek() == '[') throw std::runtime_error("sections in brackets are not used; write \"key = value\" lines alone");
    Setting setting;
    while (position_ < text_.size() && is_key_character(peek())) setting.key += text_[position_++];
    if (setting.key.empty()) throw std::runtime_error("a key of letters, digits and hyphens is expected");
    skip_spaces();
    if (at_end() || peek() != '=') throw std::runtime_error("after the key '" + setting.key + "' a \"=\" is expected");
    ++position_;
    skip_spaces();
    if (at_end()) throw std::runtime_error("the key '" + setting.key + "' has no value");
    if (peek() == '[')
      read_list(setting);
    else
      setting.values.push_back(read_value());
    skip_spaces();
    if (!at_end()) throw std::runtime_error("more than one value follows the key '" + setting.key + "'");
    return setting;
  }

 private:
  char peek() const { return text_[position_]; }
  /// Whether the line, or its part before a comment, has been parsed.
  bool at_end() const { return position_ >= text_.size() || peek() == '#'; }
  void skip_spaces() {
    while (position_ < text_.size() && is_space(peek())) ++position_;
  }

  void read_list(Setting& setting) {
    ++position_;
    for (;;) {
      skip_spaces();
      if (at_end()) throw std::runtime_error("the list of '" + setting.key + "' does not end in this line");
      if (peek() == ']') break;
      setting.values.push_back(read_value());
      skip_spaces();
      if (!at_end() && peek() == ',')
        ++position_;
      else if (at_end() || peek() != ']')
        throw std::runtime_error("in the list of '" + setting.key + "' a \",\" or \"]\" is expected");
    }
    ++position_;
  }

  std::string read_value() {
    if (peek() == '"' || peek() == '\'') return read_quoted();
    std::string text;
    while (position_ < text_.size() && !is_space(peek()) && peek() != ',' && peek() != ']' && peek() != '#')
      text += text_[position_++];
    if (!is_bare_value(text))
      throw std::runtime_error("the value '" + text + "' is neither a number nor true or false; text needs quotes: \"" +
                               text + "\"");
    return text;
  }

  /// Reads text in quotes. In double quotes a backslash escapes a double quote or a backslash; in single quotes there
  /// are no escapes.
  std::string read_quoted() {
    const char quote = text_[position_++];
    std::string text;
    while (position_ < text_.size() && peek() != quote) {
      if (quote == '"' && peek() == '\\') {
        ++position_;
        if (position_ >= text_.size() || (peek() != '"' && peek() != '\\'))
          throw std::runtime_error("between double quotes a backslash may be followed by \\ or \" alone");
      }
      text += text_[position_++];
    }
    if (position_ >= text_.size()) throw std::runtime_error("a quote is not closed in its line");
    ++position_;
    return text;
  }

  std::string_view text_;
  std::size_t position_ = 0;
};

}  // namespace

ConfigFile parse_config(std::string_view text) {
  ConfigFile file;
  int number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const auto end = std::min(text.find('\n', begin), text.size());
    ++number;
    try {
      if (auto setting = Line(text.substr(begin, end - begin)).setting()) {
        setting->line = number;
        const auto same = std::find_if(file.settings.begin(), file.settings.end(),
                                       [&](const auto& other) { return other.key == setting->key; });
        if (same != file.settings.end())
          throw std::runtime_error("the key '" + setting->key + "' was given in line " + std::to_string(same->line) +
                                   " already");
        file.settings.push_back(std::move(*setting));
      }
    } catch (const std::runtime_error& error) {
      file.faults.push_back("line " + std::to_string(number) + ": " + error.what());
    }
    begin = end + 1;
  }
  return file;
}

ConfigFile read_config_file(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) throw std::runtime_error(path.string() + " is a folder, not a file");
  std::ifstream file(path, std::ios::binary);
  std::string text(max_config_bytes + 1, '\0');
  if (file) file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!file && !file.eof()) throw std::runtime_error(path.string() + " cannot be read: " + std::strerror(errno));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > max_config_bytes)
    throw std::runtime_error(path.string() + " has more than " + std::to_string(max_config_bytes) +
                             " bytes: that is no configuration");
  return parse_config(text);
}

}  // namespace supple::configuration
