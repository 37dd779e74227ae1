#pragma once

#include <CLI/App.hpp>

#include "session.h"

namespace supple::cli {

/// Adds "families train".
void add_training_command(CLI::App& families, const GlobalOptions& options);

}  // namespace supple::cli
