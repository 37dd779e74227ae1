#pragma once

#include <cstddef>
#include <string_view>

namespace supple::problem {

/// The Levenshtein distance: the smallest number of insertions, deletions and substitutions of letters that turns one
/// word into the other. O(product of the lengths).
std::size_t edit_distance(std::string_view a, std::string_view b);

}  // namespace supple::problem
