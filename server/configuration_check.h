#pragma once

#include <string>
#include <vector>

#include "server_options.h"

namespace supple {

/// What would keep a server with these options from starting or from working, besides what reading them has found: the
/// data folder, the key file, the folders of models and of the editor, the helper program. Looks and changes nothing;
/// whether the port is free is not looked at, since a server may be running with the same configuration.
std::vector<std::string> configuration_faults(const ServerOptions& options);

}  // namespace supple
