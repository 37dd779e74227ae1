#include "supple/configuration/nearest_name.h"

#include <algorithm>
#include <cctype>

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

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row.back();
}

}  // namespace

std::optional<std::string> nearest_name(std::string_view name, const std::vector<std::string>& known) {
  if (name.size() > longest_name) return std::nullopt;
  const auto folded = without_case(name);
  std::optional<std::string> nearest;
  std::size_t fewest = folded.size() / 3 + 1;
  for (const auto& candidate : known) {
    const auto edits = edit_distance(folded, without_case(candidate));
    if (edits >= fewest) continue;
    fewest = edits;
    nearest = candidate;
  }
  return nearest;
}

}  // namespace supple::configuration
