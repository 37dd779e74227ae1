#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "supple/dataset/dataset.h"

namespace supple::dataset {

/// The path of the journal of an unfinished data set, whose finished file will be `path`.
std::filesystem::path journal_path(const std::filesystem::path& path);

/// An unfinished data set on disk. Its file only grows, by one design at a time.
///
/// Each record has its length and a CRC-32, and is synchronized before `append` returns. The process or the machine may
/// crash at any moment. All designs whose `append` has returned are read back, and an incomplete last record is cut
/// off. Only one process at a time may use a journal (flock).
class Journal {
 public:
  struct Content {
    Dataset data;                      ///< the designs, sorted by index
    std::int64_t discarded_bytes = 0;  ///< size of an incomplete last record
  };

  /// Reads a journal without locking or changing it. Throws "file.unreadable".
  static Content read(const std::filesystem::path& journal);

  /// Opens a journal or makes it. Throws "dataset.different_recipe" if it was begun with other settings, which are
  /// named, "dataset.in_use" if another process has it open, "file.unreadable" and "file.write_failed".
  Journal(const std::filesystem::path& journal, const Recipe& recipe, const Selection& selection);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// The content of the journal when it was opened.
  const Content& content() const { return content_; }
  /// Adds a design. Throws "file.write_failed".
  void append(const Design& design);
  /// Deletes the journal. Nothing can be appended afterwards.
  void remove();

 private:
  std::filesystem::path path_;
  Content content_;
  int descriptor_ = -1;
};

}  // namespace supple::dataset
