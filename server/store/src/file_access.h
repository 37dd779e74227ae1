#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

#include "supple/base/cancellation.h"
#include "supple/base/durable_file.h"

namespace supple::store {

/// Throws "store.full" where `error` (an errno) says that there is no space, "store.unavailable" otherwise: "The store
/// cannot `action` `path`: ...".
[[noreturn]] void throw_file_error(const std::string& action, const std::filesystem::path& path, int error);

/// Whether an errno says that there is no space: on the disk, in the user's disk quota, or for a file of this size.
bool is_out_of_space(int error);

/// Does what supple::write_atomically does, with errors of the store: throws "store.full", "store.unavailable".
void write_stored_file(const std::filesystem::path& path, std::initializer_list<std::string_view> pieces);

/// Writes a file without waiting for the disk, in some ten microseconds. Once this has returned, the file survives the
/// end of the process, but not a power failure. Its reader has to detect an incomplete file. Throws "store.full",
/// "store.unavailable".
void write_unsynced_file(const std::filesystem::path& path, std::initializer_list<std::string_view> pieces);

/// The bytes of a file. Throws "store.corrupted" where it is missing, "store.unavailable" where it cannot be read.
/// Checks for a stop request every few milliseconds.
std::string read_file(const std::filesystem::path& path, const CancellationToken& cancellation = {});

/// Size of a file in bytes; 0 where there is none.
std::int64_t bytes_of(const std::filesystem::path& path) noexcept;

}  // namespace supple::store
