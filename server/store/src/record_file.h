#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "supple/store/records.h"

namespace supple::store {

/// Of the file of a result.
struct ResultFile {
  std::string hash;        ///< of the body; empty where there is no result
  std::int64_t bytes = 0;  ///< of all of it
};

/// Bytes of a body. One commit is several times as fast as a file of its own whose content, name and row are
/// synchronized each; what is larger would be written twice, to the log and from it. Small ones are in a file too, for
/// which nothing waits: it is what is left of them when the database is lost.
constexpr std::size_t largest_request_in_database = 256 << 10;

/// A file that tells what it is: lines "name: value" with a hash of their own, an empty line, and a body whose hash is
/// among them. Everything that a row of the database says of the file is in it, so that the row can be made again.
class RecordFile {
 public:
  explicit RecordFile(std::string_view kind) : kind_(kind) {}

  RecordFile& add(std::string_view name, std::string_view value);
  RecordFile& add(std::string_view name, std::int64_t value) { return add(name, std::to_string(value)); }
  /// The lines before a body of this hash.
  std::string header(const std::string& body_hash) const;

  /// The value of the first field of this name; empty where there is none.
  std::string_view value(std::string_view name) const;
  /// Zero where there is none, or no integer.
  std::int64_t integer(std::string_view name) const;
  const std::vector<std::pair<std::string, std::string>>& fields() const { return fields_; }
  std::string_view body_hash() const { return value(body_hash_name); }
  /// Bytes before the body.
  std::size_t header_size() const { return header_size_; }

  /// Whether the bytes begin as such a file does.
  static bool is_one(std::string_view kind, std::string_view bytes);
  /// Reads the lines and compares them with their hash; the body is not looked at. Throws "store.corrupted" with the
  /// name of the file.
  static RecordFile parse(std::string_view kind, std::string_view bytes, const std::string& name);

 private:
  static constexpr std::string_view body_hash_name = "body-sha256";

  std::string kind_;
  std::vector<std::pair<std::string, std::string>> fields_;
  std::size_t header_size_ = 0;
};

/// How a job ended, with its answer.
inline constexpr std::string_view result_kind = "supple-result";
/// The request of a job that has not ended.
inline constexpr std::string_view request_kind = "supple-request";

RecordFile result_file(const JobRecord& job, const Result& result);
RecordFile request_file(const JobRecord& job, const JobRequest& request);

/// A job as a file of either kind has it. Throws "store.corrupted" for a state that there is not.
JobRecord job_of(const RecordFile& file);
/// A result's media type and headers.
Result result_of(const RecordFile& file);
/// A request without its body.
JobRequest request_of(const RecordFile& file);

/// Where the body begins: 0 in files of version 1, which are their body. Throws as RecordFile::parse does.
std::size_t body_offset(std::string_view kind, std::string_view bytes, const std::string& name);

/// Throws "store.corrupted": the file `name` is not what was written.
[[noreturn]] void throw_changed(const std::string& name);

/// Headers as "name: value" lines, as the database keeps them.
std::string join_headers(const Result& result);
void split_headers(const std::string& text, Result& result);

}  // namespace supple::store
