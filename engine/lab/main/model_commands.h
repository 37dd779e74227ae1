#pragma once

#include <CLI/App.hpp>

#include "stop_signals.h"

namespace supple::lab {

/// Adds "train", "symmetrize", "narrow", "correct-mesh", "calibrate" and "card". Parsing the command line runs them.
/// `interrupted` is set if a signal ended a training. The references must outlive the parsing.
void add_model_commands(CLI::App& program, const StopSignals& signals, bool& interrupted);

}  // namespace supple::lab
