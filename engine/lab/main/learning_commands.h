#pragma once

#include <CLI/App.hpp>

#include "stop_signals.h"

namespace supple::lab {

/// Adds "learn" and "plan". Parsing the command line runs them. `interrupted` is set if a signal ended a run. The
/// references must outlive the parsing.
void add_learning_commands(CLI::App& program, const StopSignals& signals, bool& interrupted);

}  // namespace supple::lab
