#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "supple/dataset/dataset.h"

namespace supple::dataset {

/// Where the unfinished data set that will be `path` is kept.
std::filesystem::path journal_path(const std::filesystem::path& path);

/// The unfinished data set on disk: a file that only grows, by one design at a time.
///
/// Each record carries its length and a CRC-32 and is synchronized before `append` returns. Whatever moment the
/// process or the machine is stopped at, all designs whose `append` returned are read back; a last record that is
/// incomplete is cut off. A design is written whole or not at all. One process at a time (flock).
class Journal {
 public:
  struct Content {
    Dataset data;                      ///< designs by index
    std::int64_t discarded_bytes = 0;  ///< of an incomplete last record
  };

  /// Reads without locking or changing it. Throws "file.unreadable".
  static Content read(const std::filesystem::path& journal);

  /// Opens or makes it. Throws "dataset.different_recipe" where it was begun with other settings (each named),
  /// "dataset.in_use" where another process has it open, "file.unreadable", "file.write_failed".
  Journal(const std::filesystem::path& journal, const Recipe& recipe, const Selection& selection);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// What it held when it was opened.
  const Content& content() const { return content_; }
  /// Throws "file.write_failed".
  void append(const Design& design);
  /// Deletes it; nothing can be appended afterwards.
  void remove();

 private:
  std::filesystem::path path_;
  Content content_;
  int descriptor_ = -1;
};

}  // namespace supple::dataset
