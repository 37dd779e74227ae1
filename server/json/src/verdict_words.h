#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace supple::json {

struct VerdictWords {
  std::string_view key;
  std::string_view text;
};

inline constexpr auto verdict_table = std::to_array<VerdictWords>({
#include "verdict_words.inc"
});

/// The template of a key of api/verdicts.json, such as "heading.missed". Another key does not compile.
consteval std::string_view verdict_words(std::string_view key) {
  const auto* row = std::find_if(verdict_table.begin(), verdict_table.end(),
                                 [key](const VerdictWords& words) { return words.key == key; });
  if (row == verdict_table.end()) throw "api/verdicts.json has no such words";
  return row->text;
}

}  // namespace supple::json
