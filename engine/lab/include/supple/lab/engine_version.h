#pragma once

#include <string>

namespace supple::lab {

/// The version of the engine, with the commit if it was built from one.
std::string engine_version();

}  // namespace supple::lab
