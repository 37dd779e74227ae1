#pragma once

#include <CLI/App.hpp>
#include <memory>

#include "part_arguments.h"

namespace supple::cli {

/// Adds `part simulate`, which tests the part that the options of `part` describe.
void add_part_simulate_command(CLI::App& part, const GlobalOptions& options,
                               std::shared_ptr<const PartArguments> arguments);

}  // namespace supple::cli
