#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace supple::design {

/// Text of a file in UTF-8, and the encoding that its bytes had.
struct DecodedText {
  std::string text;
  std::string encoding;  ///< "utf-8", "utf-16", "gbk" or "windows-1252"
};

/// Decodes the bytes of a table of measurements. UTF-16 is recognized by its byte order mark, or by the zero bytes that
/// it gives digits; bytes that are valid UTF-8 are that. Other bytes are GBK where those above 127 stand in pairs that
/// are frequent Chinese characters, and else Windows-1252, which contains Latin-1. Bytes that no character has become
/// U+FFFD; a byte order mark is dropped. O(size).
DecodedText decode_text(std::string_view bytes);

/// Whether the bytes are valid UTF-8: no overlong forms, no surrogates.
bool is_utf8(std::string_view bytes);

/// The beginning of a UTF-8 text with so many bytes at most, and "..." where something is missing.
std::string shortened(std::string_view text, std::size_t max_bytes);

/// Lower case of ASCII, of Latin letters with accents, and of Greek and Cyrillic letters; other characters stay.
std::string lower_case(std::string_view text);

}  // namespace supple::design
