#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace supple::files {

/// CRC-32 (IEEE 802.3, reflected polynomial 0xEDB88320).
std::uint32_t crc32(std::string_view bytes);

/// Appends a line with the CRC-32 of the file before it. HDF5 ignores what follows its own end of file. Throws
/// "file.write_failed".
void seal(const std::filesystem::path& path);

/// Reads the whole file and compares its CRC-32 with that of the seal. HDF5's library trusts what it reads: a damaged
/// file may give other numbers, end the process or never be done, so that its files are checked before they are opened.
/// The seal is no protection against forgery. Throws "file.unreadable": no such file, no seal, or another content.
void check_seal(const std::filesystem::path& path);
/// Checks a file whose bytes are in memory; `name` stands for it in messages.
void check_seal(std::string_view bytes, const std::string& name);

/// Checks a file of a kind that was not sealed in the past: one without a seal passes.
void check_optional_seal(const std::filesystem::path& path);

}  // namespace supple::files
