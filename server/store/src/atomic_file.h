#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace supple::store {

/// Throws "store.full" where `error` (of errno) says that there is no space, "store.unavailable" otherwise: "The store
/// cannot `action` `path`: ...".
[[noreturn]] void throw_file_error(const std::string& action, const std::filesystem::path& path, int error);

/// Whether an error number says that the disk or the user's share of it is used up.
bool means_full(int error);

/// Writes `bytes` to a neighbour of `path` and renames it into place, both durably: afterwards, or after a crash at any
/// moment, the file has all of the content or does not exist (or has its old content). Only the user of the server may
/// read it. Throws "store.full", "store.unavailable".
void write_atomically(const std::filesystem::path& path, std::string_view bytes);

/// Throws "store.corrupted" where the file is missing, "store.unavailable" where it
/// cannot be read.
std::string read_file(const std::filesystem::path& path);

/// The suffix of files that are being written.
inline constexpr std::string_view unfinished_suffix = ".part";

}  // namespace supple::store
