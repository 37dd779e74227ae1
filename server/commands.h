#pragma once

#include <optional>
#include <string>

namespace supple {

/// Runs the command that the first argument names, as in "supple-server check --data D", and returns the exit status of
/// the process. Nothing where it names none: the server itself is meant.
std::optional<int> run_command(int argc, char** argv);

/// A line for each command, for the help of the server.
std::string command_list();

}  // namespace supple
