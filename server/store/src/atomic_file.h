#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace supple::store {

/// Writes `bytes` to a neighbour of `path` and renames it into place, both durably: afterwards, or after a crash at any
/// moment, the file has all of the content or does not exist (or has its old content). Throws "store.unavailable".
void write_atomically(const std::filesystem::path& path, std::string_view bytes);

/// Throws "store.corrupted" where the file is missing, "store.unavailable" where it cannot be read.
std::string read_file(const std::filesystem::path& path);

/// The suffix of files that are being written.
inline constexpr std::string_view unfinished_suffix = ".part";

}  // namespace supple::store
