#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace supple::configuration {

/// One line "key = value" of a configuration file.
struct Setting {
  std::string key;
  std::vector<std::string> values;  ///< the texts of the value, without quotes; several where it is a list
  int line = 0;                     ///< counted from 1
};

/// What a configuration file says, and each line that could not be understood, as "line 3: ...".
struct ConfigFile {
  std::vector<Setting> settings;
  std::vector<std::string> faults;
};

/// Longer files are not configurations.
constexpr std::size_t max_config_bytes = std::size_t{1} << 20;

/// Reads the part of TOML that settings without sections need: "key = value" in a line each, where the value is "text",
/// 'text', a number, true or false, or a list of them in brackets in that line; "#" begins a comment. Keys are letters,
/// digits, "-" and "_". A key that is there twice is a fault, as TOML says. O(length).
ConfigFile parse_config(std::string_view text);

/// Reads a file. Throws std::runtime_error, which names the file, where it cannot be read or is longer than
/// `max_config_bytes`.
ConfigFile read_config_file(const std::filesystem::path& path);

}  // namespace supple::configuration
