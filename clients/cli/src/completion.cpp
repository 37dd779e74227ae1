#include "completion.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "command_tree.h"

namespace supple::cli {
namespace {

/// The text in single quotes, for sh.
std::string quoted(const std::string& text) { return "'" + replaced(text, "'", R"('\'')") + "'"; }

/// The options that may follow a command: its own and, since all others pass them on, those of the program.
std::vector<const CLI::Option*> options_after(const CLI::App& program, const CLI::App& app) {
  auto options = dashed_options(app);
  if (&app == &program) return options;
  for (const CLI::Option* option : dashed_options(program))
    if (!option->check_lname("help") && !option->check_lname("version")) options.push_back(option);
  return options;
}

/// All commands as alternatives of a case: 'supple mesh' | 'supple mesh add'.
std::string command_pattern(const std::vector<DescribedCommand>& commands, const char* separator) {
  std::vector<std::string> calls;
  for (const auto& command : commands)
    if (command.called.find(' ') != std::string::npos) calls.push_back(quoted(command.called));
  return joined(calls, separator);
}

/// The names of an option with a value as alternatives of a case: 'supple design --task' | 'supple design -t'.
std::string option_pattern(const std::string& called, const CLI::Option& option) {
  std::vector<std::string> patterns;
  for (const auto& name : spellings(option)) patterns.push_back(quoted(fmt::format("{} {}", called, name)));
  return joined(patterns, " | ");
}

/// The cases for what may follow an option with a value. `choose` makes a line of the permitted values; `anything` is
/// the line if all are permitted.
template <class Choose>
std::string value_cases(const CLI::App& program, const std::vector<DescribedCommand>& commands, const Choose& choose,
                        const char* anything) {
  std::string out;
  for (const auto& [called, app] : commands) {
    for (const CLI::Option* option : options_after(program, *app)) {
      if (!takes_value(*option)) continue;
      const auto values = choices(*option);
      out +=
          fmt::format("    {}) {} ;;\n", option_pattern(called, *option), values.empty() ? anything : choose(values));
    }
  }
  return out;
}

std::vector<std::string> option_words(const CLI::App& program, const CLI::App& app) {
  std::vector<std::string> words;
  for (const CLI::Option* option : options_after(program, app))
    for (auto& name : spellings(*option)) words.push_back(std::move(name));
  return words;
}

/// The words that can be the first one without a dash: subcommands, or the permitted values of the first argument.
std::vector<std::string> first_words(const CLI::App& app) {
  std::vector<std::string> words;
  for (const CLI::App* command : app.get_subcommands({})) words.push_back(command->get_name());
  if (const auto arguments = positional_arguments(app); words.empty() && !arguments.empty())
    words = choices(*arguments.front());
  return words;
}

std::string described_words(const CLI::App& app) {
  std::string out;
  for (const CLI::App* command : app.get_subcommands({}))
    out += " " + quoted(command->get_name() + ":" + replaced(command->get_description(), ":", "\\:"));
  if (!out.empty()) return out;
  for (const auto& word : first_words(app)) out += " " + quoted(word);
  return out;
}

std::string described_options(const CLI::App& program, const CLI::App& app) {
  std::string out;
  for (const CLI::Option* option : options_after(program, app))
    for (const auto& name : spellings(*option))
      out += "\n        " + quoted(name + ":" + replaced(option->get_description(), ":", "\\:"));
  return out;
}

std::string fish_quoted(const std::string& text) {
  return "'" + replaced(replaced(text, "\\", "\\\\"), "'", "\\'") + "'";
}

std::string fish_option(const CLI::Option& option, const std::string& condition) {
  std::string out = "complete -c supple" + condition;
  for (const auto& name : option.get_snames()) out += " -s " + name;
  for (const auto& name : option.get_lnames()) out += " -l " + name;
  if (takes_value(option)) {
    const auto values = choices(option);
    out += values.empty() ? " -r -F" : " -x -a " + fish_quoted(joined(values, " "));
  }
  return out + " -d " + fish_quoted(option.get_description()) + "\n";
}

}  // namespace

std::string bash_completion(const CLI::App& program) {
  const auto commands = commands_of(program);
  std::string out =
      "# Completes the command lines of supple in bash. Made by 'supple completion bash'.\n"
      "_supple() {\n"
      "  local word=${COMP_WORDS[COMP_CWORD]} called=supple index commands='' options=''\n"
      "  COMPREPLY=()\n"
      "  for ((index = 1; index < COMP_CWORD; ++index)); do\n"
      "    case \"$called ${COMP_WORDS[index]}\" in\n";
  out += fmt::format("      {}) called+=\" ${{COMP_WORDS[index]}}\" ;;\n    esac\n  done\n",
                     command_pattern(commands, " | "));
  out += "  case \"$called ${COMP_WORDS[COMP_CWORD-1]}\" in\n";
  out += value_cases(
      program, commands,
      [](const std::vector<std::string>& values) {
        return fmt::format("mapfile -t COMPREPLY < <(compgen -W {} -- \"$word\"); return", quoted(joined(values, " ")));
      },
      "return");
  out += "  esac\n  case \"$called\" in\n";
  for (const auto& [called, app] : commands) {
    out += fmt::format("    {}) commands={} options={} ;;\n", quoted(called), quoted(joined(first_words(*app), " ")),
                       quoted(joined(option_words(program, *app), " ")));
  }
  out +=
      "  esac\n"
      "  if [[ $word == -* ]]; then\n"
      "    mapfile -t COMPREPLY < <(compgen -W \"$options\" -- \"$word\")\n"
      "  else\n"
      "    mapfile -t COMPREPLY < <(compgen -W \"$commands\" -- \"$word\")\n"
      "  fi\n"
      "}\n"
      "complete -o bashdefault -o default -F _supple supple\n";
  return out;
}

std::string zsh_completion(const CLI::App& program) {
  const auto commands = commands_of(program);
  std::string out =
      "#compdef supple\n"
      "# Completes the command lines of supple in zsh. Made by 'supple completion zsh'.\n"
      "_supple() {\n"
      "  local called=supple index\n"
      "  local -a commands options\n"
      "  for ((index = 2; index < CURRENT; ++index)); do\n"
      "    case \"$called ${words[index]}\" in\n";
  out +=
      fmt::format("      {}) called+=\" ${{words[index]}}\" ;;\n    esac\n  done\n", command_pattern(commands, " | "));
  out += "  case \"$called ${words[CURRENT-1]}\" in\n";
  out += value_cases(
      program, commands,
      [](const std::vector<std::string>& values) { return fmt::format("compadd -- {}; return", joined(values, " ")); },
      "_files; return");
  out += "  esac\n  case \"$called\" in\n";
  for (const auto& [called, app] : commands) {
    out += fmt::format("    {})\n      commands=({} )\n      options=({}) ;;\n", quoted(called), described_words(*app),
                       described_options(program, *app));
  }
  out +=
      "  esac\n"
      "  if [[ $PREFIX == -* ]]; then\n"
      "    _describe -o option options\n"
      "  elif (( $#commands )); then\n"
      "    _describe command commands\n"
      "  else\n"
      "    _files\n"
      "  fi\n"
      "}\n"
      "if [[ ${zsh_eval_context[-1]} == loadautofunc ]]; then _supple \"$@\"; else compdef _supple supple; fi\n";
  return out;
}

std::string fish_completion(const CLI::App& program) {
  const auto commands = commands_of(program);
  std::string out =
      "# Completes the command lines of supple in fish. Made by 'supple completion fish'.\n"
      "function __supple_called\n"
      "    set -l called supple\n"
      "    for word in (commandline -opc)[2..-1]\n"
      "        switch \"$called $word\"\n";
  out += fmt::format("            case {}\n                set called \"$called $word\"\n",
                     command_pattern(commands, " "));
  out += "        end\n    end\n    echo $called\nend\n";
  for (const auto& [called, app] : commands) {
    const auto condition =
        app == &program ? std::string() : fmt::format(" -n \"test (__supple_called) = '{}'\"", called);
    for (const CLI::Option* option : dashed_options(*app)) out += fish_option(*option, condition);
    const auto here = fmt::format(" -n \"test (__supple_called) = '{}'\"", called);
    for (const CLI::App* command : app->get_subcommands({}))
      out += fmt::format("complete -c supple{} -f -a {} -d {}\n", here, command->get_name(),
                         fish_quoted(command->get_description()));
    if (app->get_subcommands({}).empty() && !first_words(*app).empty())
      out += fmt::format("complete -c supple{} -f -a {}\n", here, fish_quoted(joined(first_words(*app), " ")));
  }
  return out;
}

}  // namespace supple::cli
