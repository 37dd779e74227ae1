#pragma once

#include <string>

namespace supple::cli {

/// The key for requests: `key` itself, or the content of `file`, as the command line or the environment give them;
/// empty if both are. Warns on standard error of a file that other users may read. Throws Failure, whose message never
/// contains the key.
std::string find_key(const std::string& key, const std::string& file);

}  // namespace supple::cli
