#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

// The commands and options of the program as they are described to people and to shells.
namespace supple::cli {

/// A command with the words that call it: "supple weave layout".
struct DescribedCommand {
  std::string called;
  const CLI::App* app = nullptr;
};

/// The program and all of its commands, each before those that it has.
std::vector<DescribedCommand> commands_of(const CLI::App& program);

/// The options that are written with a dash, in their order.
std::vector<const CLI::Option*> dashed_options(const CLI::App& app);
/// The arguments that are told by their places.
std::vector<const CLI::Option*> positional_arguments(const CLI::App& app);

/// How an option may be written: "-p", "--parameters".
std::vector<std::string> spellings(const CLI::Option& option);
/// Whether the option is followed by a value.
bool takes_value(const CLI::Option& option);
/// The values from which one must be chosen; none where anything may be written.
std::vector<std::string> choices(const CLI::Option& option);

/// The words, each but the first after `separator`.
std::string joined(const std::vector<std::string>& words, const std::string& separator);

/// The text with each `from` replaced by `to`.
std::string replaced(std::string text, const std::string& from, const std::string& to);

}  // namespace supple::cli
