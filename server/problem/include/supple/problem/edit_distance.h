#pragma once

#include <cstddef>
#include <string_view>

namespace supple::problem {

/// The least number of letters to insert, delete or substitute that makes one word of the other (Levenshtein): what
/// tells a slip of the pen from another word. O(product of the lengths).
std::size_t edit_distance(std::string_view a, std::string_view b);

}  // namespace supple::problem
