#pragma once

#include <CLI/App.hpp>

#include "stop_signals.h"

namespace supple::lab {

/// Adds "train", "symmetrize", "narrow", "calibrate" and "card"; their callbacks do the work. `interrupted` is set if a
/// signal ended a training. The references must outlive the parsing.
void add_model_commands(CLI::App& program, const StopSignals& signals, bool& interrupted);

}  // namespace supple::lab
