#pragma once

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace supple {

/// Writes numbers, texts and lists one after the other, in the machine's own byte order: for messages between processes
/// of one machine, not for files.
class ByteWriter {
 public:
  template <class Number>
  ByteWriter& number(Number value) {
    static_assert(std::is_arithmetic_v<Number> || std::is_enum_v<Number>);
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    bytes_.append(bytes, sizeof value);
    return *this;
  }
  ByteWriter& size(std::size_t value) { return number(static_cast<std::uint64_t>(value)); }
  ByteWriter& text(std::string_view value) {
    size(value.size());
    bytes_ += value;
    return *this;
  }
  /// Writes the length of a list, then calls write(element) for each element.
  template <class List, class Write>
  ByteWriter& list(const List& values, const Write& write) {
    size(values.size());
    for (const auto& value : values) write(value);
    return *this;
  }
  /// The coefficients of a matrix of fixed size.
  template <class Matrix>
  ByteWriter& matrix(const Matrix& value) {
    for (decltype(value.size()) i = 0; i < value.size(); ++i) number(value.data()[i]);
    return *this;
  }

  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Reads what a ByteWriter has written. Throws std::out_of_range if the bytes end early. Keeps a reference to them.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  template <class Number>
  Number number() {
    Number value{};
    std::memcpy(&value, take(sizeof value), sizeof value);
    return value;
  }
  std::size_t size() { return static_cast<std::size_t>(number<std::uint64_t>()); }
  std::string text() {
    const std::size_t length = size();
    return {take(length), length};
  }
  /// Reads the length of a list, then calls read() for each element.
  template <class Value, class Read>
  void list(std::vector<Value>& values, const Read& read) {
    const std::size_t count = size();
    // Every element has at least one byte, so that an impossible length is found before memory is allocated.
    if (count > bytes_.size()) throw std::out_of_range("the bytes end early");
    values.reserve(count);
    for (std::size_t i = 0; i < count; ++i) values.push_back(read());
  }
  template <class Matrix>
  void matrix(Matrix& value) {
    using Number = std::remove_reference_t<decltype(value.data()[0])>;
    for (decltype(value.size()) i = 0; i < value.size(); ++i) value.data()[i] = number<Number>();
  }
  bool at_end() const { return bytes_.empty(); }

 private:
  const char* take(std::size_t count) {
    if (count > bytes_.size()) throw std::out_of_range("the bytes end early");
    const char* const begin = bytes_.data();
    bytes_.remove_prefix(count);
    return begin;
  }

  std::string_view bytes_;
};

}  // namespace supple
