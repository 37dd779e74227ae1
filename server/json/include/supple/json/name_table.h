#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>

namespace supple::json {

/// A value, mostly of an enumeration, and its name in requests and answers.
template <class Value>
struct Named {
  Value value;
  std::string_view name;
};

/// The names of all values that a field may have. Parsers, writers and messages use the same table.
template <class Value, std::size_t count>
class NameTable {
 public:
  constexpr explicit NameTable(const Named<Value> (&entries)[count]) {
    for (std::size_t i = 0; i < count; ++i) {
      entries_[i] = entries[i];
      names_[i] = entries[i].name;
    }
  }

  /// The names in the order of the table.
  constexpr std::span<const std::string_view> names() const { return names_; }
  constexpr auto begin() const { return entries_.begin(); }
  constexpr auto end() const { return entries_.end(); }

  /// Throws std::out_of_range for a value that is not in the table.
  constexpr std::string_view name_of(Value value) const {
    for (const auto& entry : entries_)
      if (entry.value == value) return entry.name;
    throw std::out_of_range("a value without a name");
  }

  constexpr std::optional<Value> find(std::string_view name) const {
    for (const auto& entry : entries_)
      if (entry.name == name) return entry.value;
    return std::nullopt;
  }

 private:
  std::array<Named<Value>, count> entries_{};
  std::array<std::string_view, count> names_{};
};

/// names_of<Switch>({{Switch::automatic, "automatic"}, ...})
template <class Value, std::size_t count>
constexpr NameTable<Value, count> names_of(const Named<Value> (&entries)[count]) {
  return NameTable<Value, count>(entries);
}

}  // namespace supple::json
