#pragma once

#include <CLI/App.hpp>

#include "stop_signals.h"

namespace supple::lab {

/// Adds all commands that this program is built with. Parsing the command line runs them. `interrupted` is set if a
/// signal ended one. The references must outlive the parsing.
void add_commands(CLI::App& program, const StopSignals& signals, bool& interrupted);

}  // namespace supple::lab
