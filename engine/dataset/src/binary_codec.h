#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "supple/dataset/dataset.h"

namespace supple::dataset {

/// Encode a record of the journal. Integers and doubles are little-endian. Strings and lists follow their 32-bit
/// length.
std::string encode(const Recipe& recipe, const Selection& selection);
std::string encode(const Design& design);

/// Decode a record. Throw "file.unreadable" if there are too few or too many bytes, or if a value is invalid.
void decode(std::string_view bytes, Recipe& recipe, Selection& selection);
Design decode_design(std::string_view bytes);

}  // namespace supple::dataset
