#pragma once

#include <string>
#include <vector>

#include "server_options.h"

namespace supple {

/// Faults of the data folder, the key file, the folders of models and of the editor, and the helper program that would
/// keep a server from starting or working. Changes nothing. The port is not checked, because a server may be running
/// with this configuration.
std::vector<std::string> configuration_faults(const ServerOptions& options);

}  // namespace supple
