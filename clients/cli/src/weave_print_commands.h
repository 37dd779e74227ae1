#pragma once

#include <CLI/App.hpp>

#include "session.h"

namespace supple::cli {

/// Adds `print` and `check` to the command `weave`.
void add_weave_print_commands(CLI::App& weave, const GlobalOptions& options);

}  // namespace supple::cli
