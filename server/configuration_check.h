#pragma once

#include <string>
#include <vector>

#include "server_options.h"

namespace supple {

/// Faults that would keep a server with these options from starting or from working, besides those found when the
/// options were read. It checks the data folder, the key file, the folders of models and of the editor, and the helper
/// program, and changes nothing. It does not check whether the port is free, because a server may be running with this
/// configuration.
std::vector<std::string> configuration_faults(const ServerOptions& options);

}  // namespace supple
