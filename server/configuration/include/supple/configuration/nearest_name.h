#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace supple::configuration {

/// The known name that was most likely meant by a misspelled one: the name with the smallest edit distance, provided
/// that this is at most a third of the number of letters. Upper and lower case count as the same letter, and so do "-"
/// and "_". O(number of names times the product of the lengths).
std::optional<std::string> nearest_name(std::string_view name, const std::vector<std::string>& known);

}  // namespace supple::configuration
