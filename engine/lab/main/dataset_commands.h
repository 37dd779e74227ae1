#pragma once

#include <CLI/App.hpp>

#include "stop_signals.h"

namespace supple::lab {

/// Adds "dataset" with make, renew, rest, merge, info and report; their callbacks do the work. `interrupted` tells
/// afterwards whether a signal ended the making. The references must outlive the parsing.
void add_dataset_commands(CLI::App& program, const StopSignals& signals, bool& interrupted);

}  // namespace supple::lab
