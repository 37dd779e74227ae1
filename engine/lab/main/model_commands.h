#pragma once

#include <CLI/App.hpp>

#include "stop_signals.h"

namespace supple::lab {

/// Adds "train". `interrupted` is set if a signal ended it.
void add_train_command(CLI::App& program, const StopSignals& signals, bool& interrupted);

/// Adds "card".
void add_card_command(CLI::App& program);

/// Adds "symmetrize".
void add_symmetrize_command(CLI::App& program);

}  // namespace supple::lab
