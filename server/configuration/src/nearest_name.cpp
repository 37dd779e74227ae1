#include "supple/configuration/nearest_name.h"

#include <cctype>

#include "supple/problem/edit_distance.h"

namespace supple::configuration {
namespace {

/// Longer names cannot be misspellings of known ones, so the search would waste time.
constexpr std::size_t max_name_length = 64;

std::string normalized(std::string_view name) {
  std::string folded;
  for (const unsigned char letter : name)
    folded += letter == '_' ? '-' : static_cast<char>(std::tolower(static_cast<int>(letter)));
  return folded;
}

}  // namespace

std::optional<std::string> nearest_name(std::string_view name, const std::vector<std::string>& known) {
  if (name.size() > max_name_length) return std::nullopt;
  const auto folded = normalized(name);
  std::optional<std::string> nearest;
  std::size_t min_edits = folded.size() / 3 + 1;
  for (const auto& candidate : known) {
    const auto edits = problem::edit_distance(folded, normalized(candidate));
    if (edits >= min_edits) continue;
    min_edits = edits;
    nearest = candidate;
  }
  return nearest;
}

}  // namespace supple::configuration
