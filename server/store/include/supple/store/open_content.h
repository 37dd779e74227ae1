#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "supple/base/durable_file.h"

namespace supple::store {

/// The content of a stored file, which is open. It can be read after the file was renamed or deleted, and is not in
/// memory. Copies share the file. Any thread may read.
class OpenContent {
 public:
  OpenContent() = default;
  /// `size` bytes of a file from `begin` on.
  OpenContent(std::shared_ptr<const OpenFile> file, std::string name, std::uint64_t begin, std::uint64_t size)
      : file_(std::move(file)), name_(std::move(name)), begin_(begin), size_(size) {}

  std::uint64_t size() const { return size_; }
  /// Reads `count` bytes from `offset` on; `offset` + `count` must be at most size(). Throws "store.unavailable", and
  /// "store.corrupted" where the file has become shorter.
  void read(std::uint64_t offset, char* to, std::size_t count) const;
  /// The whole content.
  std::string text() const;

 private:
  std::shared_ptr<const OpenFile> file_;
  std::string name_;
  std::uint64_t begin_ = 0;
  std::uint64_t size_ = 0;
};

/// The stored answer of a job.
struct StoredResult {
  std::string content_type;
  std::vector<std::pair<std::string, std::string>> headers;
  OpenContent body;
};

}  // namespace supple::store
