#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace supple::dataset {

/// Everything that decides the content of a data set, as named values in a fixed order. Two data sets with the same
/// recipe can be merged, and an interrupted one goes on only with its own recipe. A recipe names no machine, no time
/// and no number of threads.
class Recipe {
 public:
  using Value = std::variant<std::int64_t, double, std::string, std::vector<double>>;
  struct Setting {
    std::string name;
    Value value;
    std::string unit;  ///< empty for names and counts
    bool operator==(const Setting&) const = default;
  };

  void set(std::string name, Value value, std::string unit = {});
  const std::vector<Setting>& settings() const& { return settings_; }
  /// The settings would end with a recipe that has no name, before a loop over them begins.
  const std::vector<Setting>& settings() && = delete;
  bool has(std::string_view name) const;
  /// The value of that name. Throws "file.unreadable" if there is none, or none of that type.
  std::int64_t integer(std::string_view name) const;
  double number(std::string_view name) const;
  const std::string& text(std::string_view name) const;
  const std::vector<double>& numbers(std::string_view name) const;

  bool operator==(const Recipe&) const = default;

 private:
  template <class T>
  const T& get(std::string_view name) const;
  std::vector<Setting> settings_;
};

/// Writes a value so that it is read back as the same value: 17 digits, lists separated by commas.
std::string to_string(const Recipe::Value& value);

/// Returns a sentence for each setting in which the two recipes differ.
std::vector<std::string> differences(const Recipe& first, const Recipe& second);

}  // namespace supple::dataset
