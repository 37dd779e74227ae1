#pragma once

#include <CLI/CLI.hpp>

#include "server_options.h"

namespace supple {

/// Adds "supple-server keys add|list|rotate|revoke", which run when the command line is read and work on the key file
/// that `options` name then. They throw std::runtime_error.
void add_keys_commands(CLI::App& app, const ServerOptions& options);

}  // namespace supple
