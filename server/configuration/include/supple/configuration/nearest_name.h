#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace supple::configuration {

/// The known name that a misspelled one most likely means: the one with the smallest edit distance, if this is at most
/// a third of the letters. Upper and lower case are the same, and so are "-" and "_". O(number of names times the
/// product of the lengths).
std::optional<std::string> nearest_name(std::string_view name, const std::vector<std::string>& known);

}  // namespace supple::configuration
