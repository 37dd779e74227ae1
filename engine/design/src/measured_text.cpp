#include "supple/design/measured_text.h"

#include <iconv.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace supple::design {
namespace {

constexpr std::string_view utf8_mark = "\xEF\xBB\xBF";
constexpr std::string_view replacement = "\xEF\xBF\xBD";
/// Number of bytes from which UTF-16 without a byte order mark is recognized.
constexpr std::size_t max_sampled_bytes = 4096;

unsigned char byte_at(std::string_view text, std::size_t i) { return static_cast<unsigned char>(text[i]); }

/// Length of the UTF-8 sequence that begins at i; 0 if none begins there.
std::size_t sequence_length(std::string_view text, std::size_t i) {
  const unsigned char first = byte_at(text, i);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xC2 && first < 0xE0   ? 2
                             : first >= 0xE0 && first < 0xF0 ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  if (length == 0 || i + length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte_at(text, i + k) & 0xC0) != 0x80) return 0;
  }
  const unsigned char second = byte_at(text, i + 1);
  // Overlong forms, surrogates, and values beyond the last code point are invalid.
  if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second >= 0xA0)) return 0;
  if ((first == 0xF0 && second < 0x90) || (first == 0xF4 && second >= 0x90)) return 0;
  return length;
}

void append_code_point(std::string& out, std::uint32_t code) {
  if (code < 0x80) {
    out += static_cast<char>(code);
  } else if (code < 0x800) {
    out += static_cast<char>(0xC0 | (code >> 6));
    out += static_cast<char>(0x80 | (code & 0x3F));
  } else if (code < 0x10000) {
    out += static_cast<char>(0xE0 | (code >> 12));
    out += static_cast<char>(0x80 | ((code >> 6) & 0x3F));
    out += static_cast<char>(0x80 | (code & 0x3F));
  } else {
    out += static_cast<char>(0xF0 | (code >> 18));
    out += static_cast<char>(0x80 | ((code >> 12) & 0x3F));
    out += static_cast<char>(0x80 | ((code >> 6) & 0x3F));
    out += static_cast<char>(0x80 | (code & 0x3F));
  }
}

std::string from_utf16(std::string_view bytes, bool big_endian) {
  std::string out;
  const auto unit_at = [&](std::size_t i) {
    const std::uint32_t first = byte_at(bytes, i), second = byte_at(bytes, i + 1);
    return big_endian ? (first << 8) | second : (second << 8) | first;
  };
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    const std::uint32_t unit = unit_at(i);
    if (unit >= 0xD800 && unit < 0xDC00 && i + 3 < bytes.size()) {
      const std::uint32_t next = unit_at(i + 2);
      if (next >= 0xDC00 && next < 0xE000) {
        append_code_point(out, 0x10000 + ((unit - 0xD800) << 10) + (next - 0xDC00));
        i += 2;
        continue;
      }
    }
    if (unit >= 0xD800 && unit < 0xE000) {
      out += replacement;
    } else {
      append_code_point(out, unit);
    }
  }
  return out;
}

/// Characters of the bytes 0x80 to 0x9F in Windows-1252, where it differs from Latin-1. 0 stands for none.
constexpr std::array<std::uint16_t, 32> windows_1252{0x20AC, 0,      0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021,
                                                     0x02C6, 0x2030, 0x0160, 0x2039, 0x0152, 0,      0x017D, 0,
                                                     0,      0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2013, 0x2014,
                                                     0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0,      0x017E, 0x0178};

std::string from_windows_1252(std::string_view bytes) {
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::uint32_t byte = byte_at(bytes, i);
    const std::uint32_t code = byte >= 0x80 && byte < 0xA0 ? windows_1252[byte - 0x80] : byte;
    if (code == 0 && byte != 0) {
      out += replacement;
    } else {
      append_code_point(out, code);
    }
  }
  return out;
}

/// Whether all bytes above 127 begin two-byte characters of GBK, and at least 70 % of these are frequent characters of
/// GB2312. In Western texts such bytes are accented letters, which mostly stand before plain letters and rarely give
/// such a character.
bool is_probably_gbk(std::string_view bytes) {
  std::size_t pairs = 0, frequent = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const unsigned char lead = byte_at(bytes, i);
    if (lead < 0x80) continue;
    if (lead < 0x81 || lead > 0xFE || i + 1 == bytes.size()) return false;
    const unsigned char trail = byte_at(bytes, ++i);
    if (trail < 0x40 || trail == 0x7F || trail == 0xFF) return false;
    ++pairs;
    const bool is_frequent = (lead >= 0xA1 && lead <= 0xA3) || (lead >= 0xB0 && lead <= 0xD7);
    // An en dash may stand for a minus sign.
    const bool is_dash = lead == 0xA8 && trail == 0x43;
    if ((is_frequent && trail >= 0xA1) || is_dash) ++frequent;
  }
  return pairs > 0 && 10 * frequent >= 7 * pairs;
}

struct CloseConverter {
  void operator()(void* converter) const { iconv_close(converter); }
};

std::string from_gbk(std::string_view bytes) {
  std::string out;
  const auto unknown = [&] {
    for (const char c : bytes)
      out += static_cast<unsigned char>(c) < 0x80 ? std::string(1, c) : std::string(replacement);
    return out;
  };
  const iconv_t opened = iconv_open("UTF-8", "GBK");
  // Not every machine's C library has this conversion. Digits can be read without it.
  if (opened == reinterpret_cast<iconv_t>(-1)) return unknown();  // NOLINT(performance-no-int-to-ptr): its own value
  const std::unique_ptr<void, CloseConverter> converter(opened);
  std::string source(bytes);
  char* from = source.data();
  std::size_t remaining_bytes = source.size();
  std::array<char, 4096> buffer{};
  while (remaining_bytes > 0) {
    char* to = buffer.data();
    std::size_t free_bytes = buffer.size();
    const std::size_t before = remaining_bytes;
    const std::size_t result = iconv(converter.get(), &from, &remaining_bytes, &to, &free_bytes);
    out.append(buffer.data(), buffer.size() - free_bytes);
    if (result == static_cast<std::size_t>(-1) && remaining_bytes == before) {
      out += replacement;
      ++from;
      --remaining_bytes;
    }
  }
  return out;
}

/// Whether most bytes at even (parity 0) or odd (parity 1) positions are zero, as in UTF-16 of digits and Latin
/// letters.
bool has_zeros_at(std::string_view bytes, std::size_t parity) {
  std::size_t zeros = 0, all = 0;
  for (std::size_t i = parity; i < std::min(bytes.size(), max_sampled_bytes); i += 2) {
    ++all;
    zeros += byte_at(bytes, i) == 0 ? 1U : 0U;
  }
  return all > 0 && 2 * zeros > all;
}

}  // namespace

bool is_utf8(std::string_view bytes) {
  for (std::size_t i = 0; i < bytes.size();) {
    const std::size_t length = sequence_length(bytes, i);
    if (length == 0) return false;
    i += length;
  }
  return true;
}

DecodedText decode_text(std::string_view bytes) {
  if (bytes.starts_with("\xFF\xFE")) return {from_utf16(bytes.substr(2), false), "utf-16"};
  if (bytes.starts_with("\xFE\xFF")) return {from_utf16(bytes.substr(2), true), "utf-16"};
  if (has_zeros_at(bytes, 1)) return {from_utf16(bytes, false), "utf-16"};
  if (has_zeros_at(bytes, 0)) return {from_utf16(bytes, true), "utf-16"};
  if (is_utf8(bytes))
    return {std::string(bytes.starts_with(utf8_mark) ? bytes.substr(utf8_mark.size()) : bytes), "utf-8"};
  if (is_probably_gbk(bytes)) return {from_gbk(bytes), "gbk"};
  return {from_windows_1252(bytes), "windows-1252"};
}

std::string shortened(std::string_view text, std::size_t max_bytes) {
  if (text.size() <= max_bytes) return std::string(text);
  std::size_t end = max_bytes;
  while (end > 0 && (byte_at(text, end) & 0xC0) == 0x80) --end;
  return std::string(text.substr(0, end)) + "...";
}

std::string lower_case(std::string_view text) {
  std::string out(text);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const unsigned char byte = byte_at(out, i);
    if (byte >= 'A' && byte <= 'Z') out[i] = static_cast<char>(byte + ('a' - 'A'));
    if (i + 1 == out.size()) break;
    const unsigned char next = byte_at(out, i + 1);
    // Latin letters with accents: U+00C0 to U+00DE.
    if (byte == 0xC3 && next >= 0x80 && next <= 0x9E && next != 0x97) out[i + 1] = static_cast<char>(next + 0x20);
    // Greek: U+0391 to U+039F, and U+03A0 to U+03A9.
    if (byte == 0xCE && next >= 0x91 && next <= 0x9F) out[i + 1] = static_cast<char>(next + 0x20);
    if (byte == 0xCE && next >= 0xA0 && next <= 0xA9) {
      out[i] = static_cast<char>(0xCF);
      out[i + 1] = static_cast<char>(next - 0x20);
    }
    // Cyrillic: U+0410 to U+041F, and U+0420 to U+042F.
    if (byte == 0xD0 && next >= 0x90 && next <= 0x9F) out[i + 1] = static_cast<char>(next + 0x20);
    if (byte == 0xD0 && next >= 0xA0 && next <= 0xAF) {
      out[i] = static_cast<char>(0xD1);
      out[i + 1] = static_cast<char>(next - 0x20);
    }
  }
  return out;
}

}  // namespace supple::design
