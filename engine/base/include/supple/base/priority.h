#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace supple {

/// How urgent a computation is: somebody waits for it with a hand on the mouse; somebody waits for it; nobody does yet.
enum class Priority { interactive, normal, background };

/// The names in the order of the values.
inline constexpr std::array<std::string_view, 3> priority_names{"interactive", "normal", "background"};

constexpr std::string_view priority_name(Priority priority) {
  return priority_names[static_cast<std::size_t>(priority)];
}

constexpr std::optional<Priority> priority_of(std::string_view name) {
  for (std::size_t i = 0; i < priority_names.size(); ++i)
    if (priority_names[i] == name) return static_cast<Priority>(i);
  return std::nullopt;
}

}  // namespace supple
