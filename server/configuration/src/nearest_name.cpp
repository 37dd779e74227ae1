#include "supple/configuration/nearest_name.h"

#include <cctype>

#include "supple/problem/edit_distance.h"

namespace supple::configuration {
namespace {

/// Longer names are no slips of known ones, and are not worth the time.
constexpr std::size_t longest_name = 64;

std::string without_case(std::string_view name) {
  std::string folded;
  for (const unsigned char letter : name)
    folded += letter == '_' ? '-' : static_cast<char>(std::tolower(static_cast<int>(letter)));
  return folded;
}

}  // namespace

std::optional<std::string> nearest_name(std::string_view name, const std::vector<std::string>& known) {
  if (name.size() > longest_name) return std::nullopt;
  const auto folded = without_case(name);
  std::optional<std::string> nearest;
  std::size_t fewest = folded.size() / 3 + 1;
  for (const auto& candidate : known) {
    const auto edits = problem::edit_distance(folded, without_case(candidate));
    if (edits >= fewest) continue;
    fewest = edits;
    nearest = candidate;
  }
  return nearest;
}

}  // namespace supple::configuration
