#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace supple::design {

/// Text of a file in UTF-8, and the encoding of the file.
struct DecodedText {
  std::string text;
  std::string encoding;  ///< "utf-8", "utf-16", "gbk" or "windows-1252"
};

/// Decodes the bytes of a table of measurements. UTF-16 is recognized by its byte order mark, or because most bytes at
/// even or at odd positions are zero. Bytes that are valid UTF-8 are taken as UTF-8. Other bytes are GBK if all bytes
/// above 127 begin two-byte characters that are mostly frequent Chinese ones. All else is Windows-1252, which contains
/// the printable characters of Latin-1. Bytes without a character become U+FFFD, and a byte order mark is dropped.
/// O(size).
DecodedText decode_text(std::string_view bytes);

/// Whether the bytes are valid UTF-8, without overlong forms and surrogates.
bool is_utf8(std::string_view bytes);

/// The text if it has at most `max_bytes` bytes. Otherwise its beginning, cut between two characters of UTF-8, and
/// "...".
std::string shortened(std::string_view text, std::size_t max_bytes);

/// Converts ASCII, accented Latin, Greek and Cyrillic letters to lower case, and leaves other characters as they are.
std::string lower_case(std::string_view text);

}  // namespace supple::design
