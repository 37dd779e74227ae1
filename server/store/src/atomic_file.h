#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

namespace supple::store {

/// Throws "store.full" where `error` (of errno) says that there is no space, "store.unavailable" otherwise: "The store
/// cannot `action` `path`: ...".
[[noreturn]] void throw_file_error(const std::string& action, const std::filesystem::path& path, int error);

/// Whether an error number says that there is no room: on the disk, in the user's share of it, or for a file this
/// large.
bool means_full(int error);

/// Writes `pieces`, one after the other, to a neighbour of `path` and renames it into place, both durably: afterwards,
/// or after a crash at any moment, the file has all of the content or does not exist (or has its old content). Only the
/// user of the server may read it. Throws "store.full", "store.unavailable".
void write_atomically(const std::filesystem::path& path, std::initializer_list<std::string_view> pieces);

/// Throws "store.corrupted" where the file is missing, "store.unavailable" where it cannot be read.
std::string read_file(const std::filesystem::path& path);

/// Bytes of a file; 0 where there is none.
std::int64_t bytes_of(const std::filesystem::path& path) noexcept;

/// The suffix of files that are being written.
inline constexpr std::string_view unfinished_suffix = ".part";

}  // namespace supple::store
