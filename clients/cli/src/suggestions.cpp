#include "suggestions.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <string_view>

namespace supple::cli {
namespace {

constexpr std::size_t shortest_abbreviation = 3;

/// The restricted Damerau-Levenshtein distance: the number of insertions, deletions, replacements and swaps of
/// neighbouring letters that lead from one word to the other. Takes O(product of both lengths).
std::size_t edit_distance(std::string_view from, std::string_view to) {
  std::vector<std::size_t> before_last(to.size() + 1);
  std::vector<std::size_t> last(to.size() + 1);
  std::vector<std::size_t> row(to.size() + 1);
  for (std::size_t j = 0; j <= to.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= from.size(); ++i) {
    before_last.swap(last);
    last.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= to.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (from[i - 1] == to[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1])
        row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row[to.size()];
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const auto& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// The words that call the first command below `app` with the option, such as "supple relax". Empty if none has it.
std::string command_with_option(const CLI::App& app, const std::string& option, const std::string& called) {
  for (const CLI::App* command : app.get_subcommands({})) {
    auto name = called + " " + command->get_name();
    const auto names = option_names(*command);
    if (std::find(names.begin(), names.end(), option) != names.end()) return name;
    if (auto found = command_with_option(*command, option, name); !found.empty()) return found;
  }
  return {};
}

std::string unknown_option(const CLI::App& program, const std::vector<const CLI::App*>& commands,
                           const std::string& argument) {
  const std::string option = argument.substr(0, argument.find('='));
  std::vector<std::string> known;
  for (const CLI::App* command : commands)
    for (auto& name : option_names(*command)) known.push_back(std::move(name));
  std::string message = fmt::format("'{}' has no option {}", command_line_of(commands), option);
  if (const auto near = nearest_word(option, known)) return message + fmt::format("; did you mean {}?", *near);
  if (const auto owner = command_with_option(program, option, program.get_name()); !owner.empty())
    return message + fmt::format("; '{}' has", owner);
  return message;
}

std::string unknown_word(const std::vector<const CLI::App*>& commands, const std::string& word) {
  const auto names = command_names(*commands.back());
  const auto called = command_line_of(commands);
  if (names.empty()) return fmt::format("'{}' takes no further argument '{}'", called, word);
  std::string message = fmt::format("'{}' has no command '{}'", called, word);
  if (const auto near = nearest_word(word, names)) message += fmt::format("; did you mean '{}'?", *near);
  return message;
}

/// A message such as "--task: stiffnes not in {stress_strain,stiffness,poisson}", with a suggested value.
std::string with_nearest_value(const std::string& message) {
  constexpr std::string_view between = " not in {";
  const std::size_t at = message.find(between);
  const std::size_t colon = message.find(": ");
  const std::size_t end = message.find('}', at);
  if (at == std::string::npos || end == std::string::npos || colon == std::string::npos || colon > at) return message;
  const std::string value = message.substr(colon + 2, at - colon - 2);
  std::vector<std::string> values;
  std::istringstream listed(message.substr(at + between.size(), end - at - between.size()));
  for (std::string one; std::getline(listed, one, ',');) values.push_back(one);
  const auto near = nearest_word(value, values);
  return near ? message + fmt::format("; did you mean {}?", *near) : message;
}

}  // namespace

std::optional<std::string> nearest_word(const std::string& word, const std::vector<std::string>& candidates) {
  const std::string* nearest = nullptr;
  // Up to a third of the letters may be wrong, and at least one letter.
  std::size_t least_distance = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const auto& candidate : candidates) {
    const bool begins = word.size() >= shortest_abbreviation && candidate.starts_with(word);
    const std::size_t distance = begins ? 0 : edit_distance(word, candidate);
    if (distance >= least_distance) continue;
    least_distance = distance;
    nearest = &candidate;
  }
  return nearest == nullptr ? std::nullopt : std::optional(*nearest);
}

std::string suggestion(const std::string& word, const std::vector<std::string>& candidates) {
  const auto near = nearest_word(word, candidates);
  return near ? fmt::format(" (did you mean {}?)", *near) : std::string();
}

std::vector<const CLI::App*> given_commands(const CLI::App& program) {
  std::vector<const CLI::App*> commands{&program};
  while (true) {
    const auto given = commands.back()->get_subcommands();
    if (given.empty()) return commands;
    commands.push_back(given.front());
  }
}

std::string command_line_of(const std::vector<const CLI::App*>& commands) {
  std::string text;
  for (const CLI::App* command : commands) text += (text.empty() ? "" : " ") + command->get_name();
  return text;
}

std::string usage_message(const CLI::App& program, const CLI::ParseError& error) {
  const auto commands = given_commands(program);
  const auto called = command_line_of(commands);
  const auto help = fmt::format("\nSee '{} --help'.", called);
  // Unknown arguments are reported first: an option that seems to be missing may be one that is misspelt.
  const auto unknown = program.remaining(/*recurse=*/true);
  for (const auto& argument : unknown)
    if (argument.starts_with('-') && argument != "--") return unknown_option(program, commands, argument) + help;
  for (const auto& argument : unknown)
    if (argument != "--") return unknown_word(commands, argument) + help;
  const bool lacks_command = !command_names(*commands.back()).empty();
  if (lacks_command && dynamic_cast<const CLI::RequiredError*>(&error) != nullptr)
    return fmt::format("'{}' needs a command", called) + help;
  return with_nearest_value(error.what()) + help;
}

}  // namespace supple::cli
