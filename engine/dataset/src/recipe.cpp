#include "supple/dataset/recipe.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "supple/base/error.h"

namespace supple::dataset {
namespace {

std::string digits(double value) {
  std::array<char, 32> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

struct Writer {
  std::string operator()(std::int64_t value) const { return std::to_string(value); }
  std::string operator()(double value) const { return digits(value); }
  std::string operator()(const std::string& value) const { return value; }
  std::string operator()(const std::vector<double>& values) const {
    std::string text;
    for (const double value : values) text += (text.empty() ? "" : ",") + digits(value);
    return text;
  }
};

const Recipe::Setting* find(const Recipe& recipe, std::string_view name) {
  const auto& settings = recipe.settings();
  const auto found = std::find_if(settings.begin(), settings.end(), [name](const auto& s) { return s.name == name; });
  return found == settings.end() ? nullptr : &*found;
}

}  // namespace

void Recipe::set(std::string name, Value value, std::string unit) {
  settings_.push_back({std::move(name), std::move(value), std::move(unit)});
}

bool Recipe::has(std::string_view name) const { return find(*this, name) != nullptr; }

template <class T>
const T& Recipe::get(std::string_view name) const {
  const Setting* setting = find(*this, name);
  const T* value = setting ? std::get_if<T>(&setting->value) : nullptr;
  if (!value)
    throw Error("file.unreadable", "The data set's recipe lacks the setting " + std::string(name) +
                                       ", or it has another type than this version expects.");
  return *value;
}

std::int64_t Recipe::integer(std::string_view name) const { return get<std::int64_t>(name); }
double Recipe::number(std::string_view name) const { return get<double>(name); }
const std::string& Recipe::text(std::string_view name) const { return get<std::string>(name); }
const std::vector<double>& Recipe::numbers(std::string_view name) const { return get<std::vector<double>>(name); }

std::string to_string(const Recipe::Value& value) { return std::visit(Writer{}, value); }

std::vector<std::string> differences(const Recipe& first, const Recipe& second) {
  std::vector<std::string> result;
  for (const auto& setting : first.settings()) {
    const auto* other = find(second, setting.name);
    if (!other)
      result.push_back(setting.name + " is " + to_string(setting.value) + " in one and missing in the other");
    else if (*other != setting)
      result.push_back(setting.name + " is " + to_string(setting.value) + " in one and " + to_string(other->value) +
                       " in the other");
  }
  for (const auto& setting : second.settings())
    if (!find(first, setting.name))
      result.push_back(setting.name + " is missing in one and " + to_string(setting.value) + " in the other");
  return result;
}

}  // namespace supple::dataset
