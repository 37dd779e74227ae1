#pragma once

#include <CLI/CLI.hpp>

#include "server_options.h"

namespace supple {

/// Adds the commands "supple-server keys add|list|rotate|revoke". They run while `app` parses the command line, and use
/// the key file that `options` name at that time. They throw std::runtime_error.
void add_keys_commands(CLI::App& app, const ServerOptions& options);

}  // namespace supple
