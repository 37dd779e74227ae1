#include "manual_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <sstream>

#include "command_tree.h"

namespace supple::cli {
namespace {

/// The text escaped for roff: dashes can be copied, and no line begins with a control character.
std::string roff(const std::string& text) {
  std::string out = replaced(replaced(text, "\\", "\\e"), "-", "\\-");
  if (out.starts_with('.') || out.starts_with('\'')) out.insert(0, "\\&");
  return out;
}

std::string capitals(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

/// The lines without reformatting, and without the spaces that all of them begin with.
std::string verbatim(const std::vector<std::string>& lines) {
  std::size_t indentation = std::string::npos;
  for (const auto& line : lines) indentation = std::min(indentation, line.find_first_not_of(' '));
  std::string out = ".PP\n.nf\n";
  for (const auto& line : lines) out += roff(line.substr(std::min(indentation, line.size()))) + "\n";
  return out + ".fi\n";
}

/// The footer of a help text: paragraphs with a first line such as "Examples:" and lines below it, or one line of text.
/// `heading` is the macro for the first lines.
std::string closing_text(const std::string& footer, const char* heading) {
  std::string out;
  std::vector<std::string> lines;
  const auto close = [&] {
    if (lines.empty()) return;
    const bool headed = lines.front().ends_with(':');
    if (headed) {
      out += fmt::format("{} {}\n", heading, roff(capitals(lines.front().substr(0, lines.front().size() - 1))));
      lines.erase(lines.begin());
    }
    out += headed ? verbatim(lines) : ".PP\n" + roff(joined(lines, " ")) + "\n";
    lines.clear();
  };
  std::istringstream text(footer);
  for (std::string line; std::getline(text, line);) {
    if (line.empty())
      close();
    else
      lines.push_back(line);
  }
  close();
  return out;
}

std::string value_name(const CLI::Option& option) {
  if (!takes_value(option)) return {};
  const auto values = choices(option);
  if (!values.empty()) return " " + joined(values, "|");
  const bool number = option.get_type_name().starts_with("FLOAT") || option.get_type_name().starts_with("INT");
  return number ? " NUMBER" : " VALUE";
}

/// The text with permitted line breaks between the values of an option.
std::string breakable(const std::string& text) {
  std::string out;
  for (const char c : text) {
    out += c;
    if (c == '|') out += "\\:";
  }
  return out;
}

std::string option_entry(const CLI::Option& option) {
  std::string out = fmt::format(".TP\n.B {}\n{}", breakable(roff(joined(spellings(option), ", ") + value_name(option))),
                                roff(option.get_description()));
  if (!option.get_default_str().empty()) out += fmt::format(" (default: {})", roff(option.get_default_str()));
  if (!option.get_envname().empty()) out += fmt::format(" (environment: {})", roff(option.get_envname()));
  if (option.get_required()) out += " (required)";
  return out + "\n";
}

std::string synopsis(const DescribedCommand& command) {
  std::string out = command.called;
  if (!command.app->get_subcommands({}).empty()) out += " COMMAND";
  for (const CLI::Option* argument : positional_arguments(*command.app)) {
    const auto name =
        capitals(argument->get_name(/*positional=*/true)) + (argument->get_items_expected_max() > 1 ? "..." : "");
    out += argument->get_required() ? " " + name : " [" + name + "]";
  }
  return out + " [OPTION]...";
}

std::string command_section(const DescribedCommand& command) {
  std::string out = fmt::format(".SS {}\n{}.\n.PP\n.B {}\n", roff(command.called), roff(command.app->get_description()),
                                roff(synopsis(command)));
  for (const CLI::Option* argument : positional_arguments(*command.app))
    out += fmt::format(".TP\n.I {}\n{}\n", roff(capitals(argument->get_name(/*positional=*/true))),
                       roff(argument->get_description()));
  for (const CLI::Option* option : dashed_options(*command.app))
    if (!option->check_lname("help")) out += option_entry(*option);
  return out + closing_text(command.app->get_footer(), ".PP\n.I");
}

}  // namespace

std::string manual_page(const CLI::App& program, const std::string& version) {
  const auto commands = commands_of(program);
  std::string out = fmt::format(".TH SUPPLE 1 \"\" \"supple {}\" \"User Commands\"\n", roff(version));
  out += ".SH NAME\nsupple \\- design of elastic things by a supple\\-server\n";
  out += fmt::format(".SH SYNOPSIS\n.B {}\n", roff(synopsis(commands.front())));
  out += fmt::format(".SH DESCRIPTION\n{}.\n", roff(program.get_description()));
  out += ".SH OPTIONS\nThese may stand before and after a command.\n";
  for (const CLI::Option* option : dashed_options(program)) out += option_entry(*option);
  out += ".SH COMMANDS\n";
  for (auto command = commands.begin() + 1; command != commands.end(); ++command) out += command_section(*command);
  return out + closing_text(program.get_footer(), ".SH");
}

}  // namespace supple::cli
