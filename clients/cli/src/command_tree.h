#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

// The commands and options of the program, for descriptions of them for people and for shells.
namespace supple::cli {

/// A command with the words that call it, such as "supple weave layout".
struct DescribedCommand {
  std::string called;
  const CLI::App* app = nullptr;
};

/// The program and all of its commands, each before its own subcommands.
std::vector<DescribedCommand> commands_of(const CLI::App& program);

/// The options that begin with a dash, in their order.
std::vector<const CLI::Option*> dashed_options(const CLI::App& app);
/// The positional arguments.
std::vector<const CLI::Option*> positional_arguments(const CLI::App& app);

/// The names of an option with their dashes: "-p", "--parameters".
std::vector<std::string> spellings(const CLI::Option& option);
/// Whether the option is followed by a value.
bool takes_value(const CLI::Option& option);
/// The values that an option permits; none if it permits any.
std::vector<std::string> choices(const CLI::Option& option);

/// The words with `separator` between them.
std::string joined(const std::vector<std::string>& words, const std::string& separator);

/// The text with each `from` replaced by `to`.
std::string replaced(std::string text, const std::string& from, const std::string& to);

}  // namespace supple::cli
