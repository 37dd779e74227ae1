#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace supple::json {

/// Sets the largest size of a JSON answer in bytes (setting --max-answer). Called once, before the first answer.
void set_answer_limit(std::size_t bytes);

/// Writes JSON into a string, without building a document first.
///
/// Numbers are the shortest text that reads back as the same double. The output is always valid: a number that is not
/// finite throws Error "computation.non_finite" with its key; text that is not UTF-8 has its faulty bytes replaced by
/// U+FFFD. Keys must be literals or known to need no escapes, or be written by `text_key`. An answer beyond its limit
/// throws ProblemError "answer.too_large" before it has grown further.
class JsonWriter {
 public:
  JsonWriter& begin_object() { return open('{'); }
  JsonWriter& end_object() { return close('}'); }
  JsonWriter& begin_array() { return open('['); }
  JsonWriter& end_array() { return close(']'); }
  JsonWriter& key(std::string_view name);
  /// A key that may need escapes.
  JsonWriter& text_key(std::string_view name);

  JsonWriter& number(double value);
  JsonWriter& integer(std::int64_t value);
  JsonWriter& boolean(bool value);
  JsonWriter& null();
  JsonWriter& string(std::string_view text);
  /// Text that is JSON already.
  JsonWriter& raw(std::string_view json);

  JsonWriter& field(std::string_view name, std::floating_point auto value) { return key(name).number(value); }
  JsonWriter& field(std::string_view name, std::same_as<bool> auto value) { return key(name).boolean(value); }
  JsonWriter& field(std::string_view name, std::integral auto value) requires(!std::same_as<decltype(value), bool>) {
    return key(name).integer(static_cast<std::int64_t>(value));
  }
  JsonWriter& field(std::string_view name, std::string_view text) { return key(name).string(text); }

  /// An array of numbers; `values` is anything with size() and operator[].
  template <class Vector>
  JsonWriter& numbers(const Vector& values) {
    begin_array();
    for (decltype(values.size()) i = 0; i < values.size(); ++i) number(values[i]);
    return end_array();
  }

  std::string take() { return std::move(text_); }

 private:
  JsonWriter& open(char bracket);
  JsonWriter& close(char bracket);
  void separate();

  std::string text_;
  std::string_view last_key_;
  bool needs_comma_ = false;
};

}  // namespace supple::json
