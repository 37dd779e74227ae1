#include "supple/files/seal.h"

#include <array>
#include <cstdio>
#include <fstream>
#include <string>

#include "supple/base/durable_file.h"
#include "supple/base/error.h"

namespace supple::files {
namespace {

constexpr std::string_view mark = "\nsupple CRC-32 ";
/// Bytes of the mark, eight hexadecimal digits and the end of the line.
constexpr std::size_t seal_size = mark.size() + 9;

constexpr std::array<std::uint32_t, 256> crc_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit) value = (value >> 1) ^ ((value & 1U) != 0 ? 0xEDB88320U : 0U);
    table[i] = value;
  }
  return table;
}

std::string seal_of(std::string_view content) {
  std::array<char, 9> digits{};
  std::snprintf(digits.data(), digits.size(), "%08x", static_cast<unsigned>(crc32(content)));
  return std::string(mark) + digits.data() + "\n";
}

bool has_seal(std::string_view bytes) {
  return bytes.size() >= seal_size && bytes.substr(bytes.size() - seal_size, mark.size()) == mark;
}

void compare(const std::string& name, std::string_view bytes) {
  if (bytes.substr(bytes.size() - seal_size) != seal_of(bytes.substr(0, bytes.size() - seal_size)))
    throw Error("file.unreadable", name + ": it is damaged: its content does not have its checksum.");
}

}  // namespace

std::uint32_t crc32(std::string_view bytes) {
  static constexpr auto table = crc_table();
  std::uint32_t value = 0xFFFFFFFFU;
  for (const char byte : bytes) value = (value >> 8) ^ table[(value ^ static_cast<unsigned char>(byte)) & 0xFFU];
  return ~value;
}

void seal(const std::filesystem::path& path) {
  const auto line = seal_of(content_of(path));
  std::ofstream file(path, std::ios::binary | std::ios::app);
  file << line;
  file.close();
  if (!file) throw Error("file.write_failed", "Cannot write " + path.string() + ".");
}

void check_seal(const std::filesystem::path& path) { check_seal(content_of(path), path.string()); }

void check_seal(std::string_view bytes, const std::string& name) {
  if (!has_seal(bytes))
    throw Error("file.unreadable", name + ": it has no checksum at its end: it is cut off, or of another kind.");
  compare(name, bytes);
}

void check_optional_seal(const std::filesystem::path& path) {
  const auto content = content_of(path);
  if (has_seal(content)) compare(path.string(), content);
}

}  // namespace supple::files
