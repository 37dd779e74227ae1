#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace supple::configuration {

/// The known name that a slip of the pen most likely meant: the one with the fewest insertions, deletions and
/// substitutions of letters, where these are at most a third of the letters. Upper and lower case are the same, and so
/// are "-" and "_". O(number of names times length of both).
std::optional<std::string> nearest_name(std::string_view name, const std::vector<std::string>& known);

}  // namespace supple::configuration
