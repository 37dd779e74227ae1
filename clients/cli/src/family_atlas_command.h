#pragma once

#include <CLI/App.hpp>

#include "session.h"

namespace supple::cli {

/// Adds `families atlas` to the command `families`.
void add_family_atlas_command(CLI::App& families, const GlobalOptions& options);

}  // namespace supple::cli
