#pragma once

#include <CLI/App.hpp>

#include "stop_signals.h"

namespace supple::lab {

/// Adds all commands that this program is built with; their callbacks do the work. `interrupted` tells afterwards
/// whether a signal ended it. The references must outlive the parsing.
void add_commands(CLI::App& program, const StopSignals& signals, bool& interrupted);

}  // namespace supple::lab
