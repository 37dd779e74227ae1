#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace supple::configuration {

/// One line "key = value" of a configuration file.
struct Setting {
  std::string key;
  std::vector<std::string> values;  ///< the value without quotes; several values if it is a list
  int line = 0;                     ///< counted from 1
};

/// The content of a configuration file.
struct ConfigFile {
  std::vector<Setting> settings;
  std::vector<std::string> faults;  ///< one text "line 3: ..." for each line that is not valid
};

/// Largest size of a configuration file in bytes.
constexpr std::size_t max_config_bytes = std::size_t{1} << 20;

/// Parses a part of TOML that suffices for settings without sections. A line has the form "key = value". A key consists
/// of letters, digits, "-" and "_". A value is "text", 'text', a number, true, false, or a list of these in brackets in
/// the same line. "#" begins a comment. As in TOML, a repeated key is a fault. O(length).
ConfigFile parse_config(std::string_view text);

/// Reads and parses a file. Throws std::runtime_error, which names the file, if it cannot be read or is longer than
/// `max_config_bytes`.
ConfigFile read_config_file(const std::filesystem::path& path);

}  // namespace supple::configuration
