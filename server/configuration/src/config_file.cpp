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

bool is_of_key(char letter) {
  return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') || (letter >= '0' && letter <= '9') ||
         letter == '-' || letter == '_';
}

/// Whether TOML allows the text without quotes: a number or a truth value.
bool is_bare_value(const std::string& text) {
  if (text == "true" || text == "false") return true;
  if (text.empty()) return false;
  std::istringstream number(text);
  double value = 0;
  number >> value;
  return !number.fail() && number.peek() == std::istringstream::traits_type::eof();
}

/// Goes through one line; throws std::runtime_error that says what is wrong with it.
class Line {
 public:
  explicit Line(std::string_view text) : text_(text) {}

  /// Nothing for an empty line or a comment.
  std::optional<Setting> setting() {
    skip_spaces();
    if (at_end()) return std::nullopt;
    if (peek() == '[') throw std::runtime_error("sections in brackets are not used; write \"key = value\" lines alone");
    Setting setting;
    while (place_ < text_.size() && is_of_key(peek())) setting.key += text_[place_++];
    if (setting.key.empty()) throw std::runtime_error("a key of letters, digits and hyphens is expected");
    skip_spaces();
    if (at_end() || peek() != '=') throw std::runtime_error("after the key '" + setting.key + "' a \"=\" is expected");
    ++place_;
    skip_spaces();
    if (at_end()) throw std::runtime_error("the key '" + setting.key + "' has no value");
    if (peek() == '[')
      list(setting);
    else
      setting.values.push_back(value());
    skip_spaces();
    if (!at_end()) throw std::runtime_error("more than one value follows the key '" + setting.key + "'");
    return setting;
  }

 private:
  char peek() const { return text_[place_]; }
  /// A comment ends the line.
  bool at_end() const { return place_ >= text_.size() || peek() == '#'; }
  void skip_spaces() {
    while (place_ < text_.size() && is_space(peek())) ++place_;
  }

  void list(Setting& setting) {
    ++place_;
    for (;;) {
      skip_spaces();
      if (at_end()) throw std::runtime_error("the list of '" + setting.key + "' does not end in this line");
      if (peek() == ']') break;
      setting.values.push_back(value());
      skip_spaces();
      if (!at_end() && peek() == ',')
        ++place_;
      else if (at_end() || peek() != ']')
        throw std::runtime_error("in the list of '" + setting.key + "' a \",\" or \"]\" is expected");
    }
    ++place_;
  }

  std::string value() {
    if (peek() == '"' || peek() == '\'') return quoted();
    std::string text;
    while (place_ < text_.size() && !is_space(peek()) && peek() != ',' && peek() != ']' && peek() != '#')
      text += text_[place_++];
    if (!is_bare_value(text))
      throw std::runtime_error("the value '" + text + "' is neither a number nor true or false; text needs quotes: \"" +
                               text + "\"");
    return text;
  }

  /// Between double quotes a backslash keeps the next quote or backslash; between single quotes all is as it stands.
  std::string quoted() {
    const char quote = text_[place_++];
    std::string text;
    while (place_ < text_.size() && peek() != quote) {
      if (quote == '"' && peek() == '\\') {
        ++place_;
        if (place_ >= text_.size() || (peek() != '"' && peek() != '\\'))
          throw std::runtime_error("between double quotes a backslash may be followed by \\ or \" alone");
      }
      text += text_[place_++];
    }
    if (place_ >= text_.size()) throw std::runtime_error("a quote is not closed in its line");
    ++place_;
    return text;
  }

  std::string_view text_;
  std::size_t place_ = 0;
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
