#pragma once

namespace supple::cli {

/// The output of `supple --version`, for example "0.2.0+7.g1a2b3c4d5e6f" (cmake/SuppleVersion.cmake).
const char* program_version();

}  // namespace supple::cli
