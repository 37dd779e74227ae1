#pragma once

#include <optional>
#include <string>

namespace supple {

/// Runs the command that the first argument names, as in "supple-server check --data D", and returns the exit status of
/// the process. Returns nothing if the argument names no command: then the server is to be started.
std::optional<int> run_command(int argc, char** argv);

/// One line for each command, for the server's help text.
std::string command_list();

}  // namespace supple
