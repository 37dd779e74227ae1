#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace supple::files {

/// Owns one HDF5 identifier.
class Hdf5Handle {
 public:
  using Close = int (*)(std::int64_t);
  Hdf5Handle() = default;
  Hdf5Handle(std::int64_t id, Close close) : id_(id), close_(close) {}
  Hdf5Handle(Hdf5Handle&& other) noexcept : id_(other.id_), close_(other.close_) { other.id_ = -1; }
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept;
  ~Hdf5Handle() { reset(); }

  std::int64_t get() const { return id_; }
  /// Closes the object, which may write. Returns whether this succeeded.
  bool reset() noexcept;

 private:
  std::int64_t id_ = -1;
  Close close_ = nullptr;
};

/// How a column of real numbers is stored.
struct ColumnStorage {
  bool single_precision = false;
  bool compressed = false;
};

/// Writes a new file of groups, columns and attributes. Nothing in it depends on the time. Every member throws
/// "file.write_failed".
class Hdf5Writer {
 public:
  explicit Hdf5Writer(const std::filesystem::path& path);
  /// Writes a file that is in memory alone; `bytes` gives it.
  Hdf5Writer();

  void group(const std::string& name);
  /// A column of `values.size() / components` rows; `components` 0 makes it one-dimensional. T: double, std::int64_t,
  /// std::int32_t or std::uint8_t.
  template <class T>
  void column(const std::string& name, const std::vector<T>& values, int components, ColumnStorage storage = {});
  void column(const std::string& name, const std::vector<std::string>& values);
  /// A single value.
  void value(const std::string& name, std::int64_t value);
  void value(const std::string& name, double value);
  void value(const std::string& name, const std::string& value);
  /// An attribute of the group or column `object`; "/" is the file.
  void attribute(const std::string& object, const std::string& name, const std::string& text);
  void attribute(const std::string& object, const std::string& name, std::int64_t value);
  void close();
  /// The bytes of what has been written so far.
  std::string bytes() const;

 private:
  std::filesystem::path path_;
  Hdf5Handle file_;
};

/// Reads such files. Every member throws "file.unreadable", with the name of what is missing or has another form.
class Hdf5Reader {
 public:
  enum class Kind { integer, real, reals, text };
  explicit Hdf5Reader(const std::filesystem::path& path);
  /// Reads a file whose bytes are in memory; `name` stands for it in messages. The bytes are copied.
  Hdf5Reader(std::string_view bytes, const std::string& name);

  /// The names of a group's members, in the order in which they were written.
  std::vector<std::string> members(const std::string& group) const;
  /// Whether the file itself has a member of this name (no path).
  bool contains(const std::string& name) const;
  /// The form of a member: a single integer, real or text, or a list of reals.
  Kind kind(const std::string& name) const;
  /// The column's values; it must have `components` columns as in Hdf5Writer::column and, unless `rows` < 0, as many
  /// rows.
  template <class T>
  std::vector<T> column(const std::string& name, int components, std::int64_t rows = -1) const;
  std::vector<std::string> text_column(const std::string& name, std::int64_t rows = -1) const;
  std::int64_t integer(const std::string& name) const;
  double real(const std::string& name) const;
  std::string text(const std::string& name) const;
  std::string text_attribute(const std::string& object, const std::string& name) const;
  std::int64_t integer_attribute(const std::string& object, const std::string& name) const;
  /// The number of columns of a two-dimensional column.
  int components(const std::string& name) const;

 private:
  std::filesystem::path path_;
  Hdf5Handle file_;
};

}  // namespace supple::files
