#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

#include "supple/base/cancellation.h"
#include "supple/base/durable_file.h"

namespace supple::store {

/// Throws "store.full" where `error` (of errno) says that there is no space, "store.unavailable" otherwise: "The store
/// cannot `action` `path`: ...".
[[noreturn]] void throw_file_error(const std::string& action, const std::filesystem::path& path, int error);

/// Whether an error number says that there is no room: on the disk, in the user's share of it, or for a file this
/// large.
bool means_full(int error);

/// As supple::write_atomically, with errors of the store: throws "store.full", "store.unavailable".
void write_stored_file(const std::filesystem::path& path, std::initializer_list<std::string_view> pieces);

/// Writes a file that may be lost with a power failure, but with no end of the process once this has returned: it waits
/// for no disk, some ten microseconds. Its reader has to know when it is incomplete. Throws "store.full",
/// "store.unavailable".
void write_spare_file(const std::filesystem::path& path, std::initializer_list<std::string_view> pieces);

/// Throws "store.corrupted" where the file is missing, "store.unavailable" where it cannot be read.
/// Looks at the token every few milliseconds.
std::string read_file(const std::filesystem::path& path, const CancellationToken& cancellation = {});

/// Bytes of a file; 0 where there is none.
std::int64_t bytes_of(const std::filesystem::path& path) noexcept;

}  // namespace supple::store
