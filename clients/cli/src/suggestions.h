#pragma once

#include <CLI/App.hpp>
#include <optional>
#include <string>
#include <vector>

namespace supple::cli {

/// The candidate that `word` most likely is a misspelling of: one that begins with it, or else the one at the least
/// edit distance. Nothing if all are too far.
std::optional<std::string> nearest_word(const std::string& word, const std::vector<std::string>& candidates);

/// " (did you mean X?)", or an empty text if no candidate is near.
std::string suggestion(const std::string& word, const std::vector<std::string>& candidates);

/// The commands on the command line, from the program itself to the innermost.
std::vector<const CLI::App*> given_commands(const CLI::App& program);

/// The words that call a command, such as "supple weave layout".
std::string command_line_of(const std::vector<const CLI::App*>& commands);

/// Why a command line cannot be understood: a sentence that suggests a correction of a misspelt command, option or
/// value, and a second one that says where to find help.
std::string usage_message(const CLI::App& program, const CLI::ParseError& error);

}  // namespace supple::cli
