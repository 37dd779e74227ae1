#pragma once

#include <CLI/App.hpp>
#include <optional>
#include <string>
#include <vector>

namespace supple::cli {

/// The candidate that `word` most likely is a slip of: one that begins with it, or else the one from which the fewest
/// insertions, deletions, replacements and swaps of neighbouring letters lead to it. Nothing where all are too far.
std::optional<std::string> nearest_word(const std::string& word, const std::vector<std::string>& candidates);

/// " (did you mean X?)", or nothing where no candidate is near.
std::string suggestion(const std::string& word, const std::vector<std::string>& candidates);

/// The commands that were given, from the program itself to the innermost.
std::vector<const CLI::App*> given_commands(const CLI::App& program);

/// How a command is called: "supple weave layout".
std::string command_line_of(const std::vector<const CLI::App*>& commands);

/// Why a command line cannot be understood, in one sentence that suggests what a misspelt command, option or value was
/// meant to be, and a second one that says where there is help.
std::string usage_message(const CLI::App& program, const CLI::ParseError& error);

}  // namespace supple::cli
