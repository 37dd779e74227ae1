#pragma once

#include <cstddef>
#include <string_view>

namespace supple::json {

/// Length in bytes (1 to 4) of the code point that the text begins with; 0 where it begins with none (RFC 3629: no
/// overlong forms, no surrogates, nothing above U+10FFFF). `text` is not empty.
std::size_t utf8_sequence_length(std::string_view text);

/// Position of the first byte that is not UTF-8; npos where all is. O(n), about 8 bytes at a time for ASCII.
std::size_t first_invalid_utf8(std::string_view text);

}  // namespace supple::json
