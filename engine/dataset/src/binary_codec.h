#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "supple/dataset/dataset.h"

namespace supple::dataset {

/// The journal's records: little-endian integers and doubles, strings and lists after their 32-bit length.
std::string encode(const Recipe& recipe, const Selection& selection);
std::string encode(const Design& design);

/// The reverse. Throw "file.unreadable" where the bytes end early, go on too long or make no sense.
void decode(std::string_view bytes, Recipe& recipe, Selection& selection);
Design decode_design(std::string_view bytes);

}  // namespace supple::dataset
