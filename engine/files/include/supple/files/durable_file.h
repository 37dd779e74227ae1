#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace supple::files {

/// Throws "file.write_failed" with errno's message.
[[noreturn]] void throw_write_failed(const std::string& action, const std::filesystem::path& path);

/// Writes all of `bytes` at the end of an open file, and synchronizes it. `path` is for the message.
void append_durably(int descriptor, std::string_view bytes, const std::filesystem::path& path);

/// Makes names in the folder of `path` outlive a power failure.
void synchronize_folder_of(const std::filesystem::path& path);

/// Synchronizes the file `finished` and renames it to `place`, which it replaces.
void move_into_place(const std::filesystem::path& finished, const std::filesystem::path& place);

}  // namespace supple::files
