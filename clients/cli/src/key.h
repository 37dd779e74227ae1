#pragma once

#include <string>

namespace supple::cli {

/// The key to send, from what the command line and the environment name: the key itself, or a file that holds it. Empty
/// where they name neither. Warns on standard error of a file that others may read. Throws Failure, which never repeats
/// the key.
std::string find_key(const std::string& key, const std::string& file);

}  // namespace supple::cli
