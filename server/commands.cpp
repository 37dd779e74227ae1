#include "commands.h"

#include <array>
#include <exception>
#include <iostream>
#include <string_view>

#include "store_commands.h"

namespace supple {
namespace {

struct Command {
  std::string_view name;
  std::string_view summary;
  /// The arguments begin with the command's name. Returns the exit status. If it throws, the text is printed and the
  /// status is 1.
  int (*run)(int argc, char** argv);
};

constexpr std::array commands{
    Command{"backup", "Copies a data folder, also while a server uses it", backup_command},
    Command{"check", "Looks for what is damaged or missing in a data folder, and repairs it", check_command},
    Command{"restore", "Makes a data folder of a backup", restore_command},
};

}  // namespace

std::optional<int> run_command(int argc, char** argv) {
  if (argc < 2) return std::nullopt;
  for (const auto& command : commands) {
    if (command.name != argv[1]) continue;
    try {
      return command.run(argc - 1, argv + 1);
    } catch (const std::exception& error) {
      std::cerr << "supple-server " << command.name << ": " << error.what() << '\n';
      return 1;
    }
  }
  return std::nullopt;
}

std::string command_list() {
  std::string text = "Commands (supple-server COMMAND --help says more):";
  for (const auto& command : commands) {
    text.append("\n  ").append(command.name).append(": ").append(command.summary).append(".");
  }
  return text;
}

}  // namespace supple
