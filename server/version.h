#pragma once

namespace supple {

/// The version that `supple-server --version` prints and /healthz answers, for example "0.2.0+7.g1a2b3c4d5e6f"
/// (cmake/SuppleVersion.cmake).
const char* server_version();

}  // namespace supple
