#include "command_tree.h"

#include <sstream>

namespace supple::cli {
namespace {

void append_commands(const std::string& called, const CLI::App& app, std::vector<DescribedCommand>& commands) {
  commands.push_back({called, &app});
  for (const CLI::App* command : app.get_subcommands({}))
    append_commands(called + " " + command->get_name(), *command, commands);
}

}  // namespace

std::vector<DescribedCommand> commands_of(const CLI::App& program) {
  std::vector<DescribedCommand> commands;
  append_commands(program.get_name(), program, commands);
  return commands;
}

std::vector<const CLI::Option*> dashed_options(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return option->nonpositional(); });
}

std::vector<const CLI::Option*> positional_arguments(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return option->get_positional(); });
}

std::vector<std::string> spellings(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const auto& name : option.get_snames()) names.push_back("-" + name);
  for (const auto& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

std::vector<std::string> choices(const CLI::Option& option) {
  // CLI11 shows the permitted values in the name of the type only: "TEXT:{on,off}".
  const std::string type = option.get_type_name();
  const std::size_t begin = type.find('{');
  const std::size_t end = type.find('}', begin);
  std::vector<std::string> values;
  if (begin == std::string::npos || end == std::string::npos) return values;
  std::istringstream listed(type.substr(begin + 1, end - begin - 1));
  for (std::string value; std::getline(listed, value, ',');) values.push_back(value);
  return values;
}

std::string joined(const std::vector<std::string>& words, const std::string& separator) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

}  // namespace supple::cli
