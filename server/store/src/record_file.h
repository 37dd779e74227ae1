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

/// Hash and size of the file of a result.
struct ResultFile {
  std::string hash;        ///< hash of the body; empty where there is no result
  std::int64_t bytes = 0;  ///< bytes of the whole file
};

/// Largest body of a request in the database, in bytes. One commit is several times as fast as a file, whose content,
/// name and row are synchronized separately. But the database writes a body twice, to its log and from there. A local
/// store also writes small requests to unsynchronized files, which remain if the database is lost.
constexpr std::size_t max_request_in_database = 256 << 10;

/// A file that describes itself: header lines "name: value" with a hash of their own, an empty line, and a body, whose
/// hash is among the values. The header has everything that the file's row has, so that the row can be made again.
class RecordFile {
 public:
  explicit RecordFile(std::string_view kind) : kind_(kind) {}

  RecordFile& add(std::string_view name, std::string_view value);
  RecordFile& add(std::string_view name, std::int64_t value) { return add(name, std::to_string(value)); }
  /// The header of a file whose body has this hash.
  std::string header(const std::string& body_hash) const;

  /// The value of the first field of this name; empty where there is none.
  std::string_view value(std::string_view name) const;
  /// The value as an integer; zero where there is none, or no integer.
  std::int64_t integer(std::string_view name) const;
  const std::vector<std::pair<std::string, std::string>>& fields() const { return fields_; }
  std::string_view body_hash() const { return value(body_hash_name); }
  /// Bytes before the body.
  std::size_t header_size() const { return header_size_; }

  /// Whether the bytes begin as a header of this kind does.
  static bool starts_with_header(std::string_view kind, std::string_view bytes);
  /// Reads the header and compares it with its hash; the body is not read. Throws "store.corrupted" with the name of
  /// the file.
  static RecordFile parse(std::string_view kind, std::string_view bytes, const std::string& name);

 private:
  static constexpr std::string_view body_hash_name = "body-sha256";

  std::string kind_;
  std::vector<std::pair<std::string, std::string>> fields_;
  std::size_t header_size_ = 0;
};

/// Kind of the file of a result: how a job ended, with its answer.
inline constexpr std::string_view result_kind = "supple-result";
/// Kind of the file of the request of an unfinished job.
inline constexpr std::string_view request_kind = "supple-request";

RecordFile result_file(const JobRecord& job, const Result& result);
RecordFile request_file(const JobRecord& job, const JobRequest& request);

/// The job in the header of a file of either kind. Throws "store.corrupted" for an unknown state.
JobRecord job_of(const RecordFile& file);
/// The media type and the headers of a result, without its body.
Result result_of(const RecordFile& file);
/// A request without its body.
JobRequest request_of(const RecordFile& file);

/// The request whose header and body are `bytes`, from a file or from the database. Throws "store.corrupted" with the
/// name of the file where one of the hashes is wrong.
StoredRequest stored_request(std::string bytes, const std::string& name);

/// Offset of the body in bytes: 0 in files of version 1, which have no header. Throws as RecordFile::parse does.
std::size_t body_offset(std::string_view kind, std::string_view bytes, const std::string& name);

/// Throws "store.corrupted": the file `name` is not what was written.
[[noreturn]] void throw_corrupted(const std::string& name);
/// Throws "store.corrupted" with missing_file_message().
[[noreturn]] void throw_missing(const std::string& name);
/// "The stored file `name` is missing."
std::string missing_file_message(const std::string& name);

/// The response headers as "name: value" lines, as the database has them.
std::string join_headers(const Result& result);
void split_headers(const std::string& text, Result& result);

}  // namespace supple::store
