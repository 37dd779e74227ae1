#pragma once

#include <cstdint>
#include <mutex>
#include <string_view>

#include "data_folder.h"
#include "owner_table.h"
#include "supple/store/store.h"

namespace supple::store {

/// The kinds of what is stored whose bytes are counted. Families are rows of the database.
enum class Category { meshes, results, requests, families };

/// The bytes of files of a category in `usage`.
std::int64_t& bytes_of_category(Usage& usage, Category category);

/// Number of bytes that have to be removed before `bytes` new ones fit into the limit of all data. Throws ProblemError
/// "store.quota" where removing all results would not make enough room, and for meshes beyond their own limit.
std::int64_t excess_bytes(const Usage& usage, Category category, std::int64_t bytes);

/// Throws ProblemError "store.quota" for bytes that do not fit into the limit of all data.
[[noreturn]] void refuse_store(const Usage& usage, Category category, std::int64_t bytes);

/// Counts the bytes of a data folder: at the start from the sizes of all files, from then on from what is written and
/// removed. Any thread may call.
class UsageCounter {
 public:
  UsageCounter(const DataPaths& paths, const Quota& quota) : paths_(paths), quota_(quota) {}

  /// Counts every file anew, O(number of files).
  void count();
  /// Counts the files in quarantine, which an operator may empty at any time.
  void count_quarantine();
  void add(Category category, std::int64_t bytes);

  /// Adds `bytes` and returns 0 if they fit. Otherwise adds nothing and returns excess_bytes(), which may throw.
  std::int64_t try_add(Category category, std::int64_t bytes);
  /// Throws ProblemError "store.quota" for bytes that do not fit into the limit of all data.
  [[noreturn]] void refuse(Category category, std::int64_t bytes) const { refuse_store(usage(), category, bytes); }

  Usage usage() const;

 private:
  /// The usage now. Requires the mutex.
  Usage measured() const;

  const DataPaths paths_;
  const Quota quota_;
  mutable std::mutex mutex_;
  Usage counted_;
};

/// Throws ProblemError "store.key_quota": new bytes would take an owner beyond its limit.
[[noreturn]] void refuse_owner(const std::string& owner, const OwnerUsage& owner_usage, Category category,
                               std::int64_t bytes, std::int64_t limit);

/// Bytes that are counted for a file before it is written. They are subtracted again unless commit() is called.
class SpaceClaim {
 public:
  SpaceClaim(UsageCounter& counter, Category category, std::int64_t bytes)
      : counter_(counter), category_(category), bytes_(bytes) {}
  ~SpaceClaim() {
    if (!committed_) counter_.add(category_, -bytes_);
  }
  SpaceClaim(const SpaceClaim&) = delete;
  SpaceClaim& operator=(const SpaceClaim&) = delete;
  void commit() { committed_ = true; }

 private:
  UsageCounter& counter_;
  const Category category_;
  const std::int64_t bytes_;
  bool committed_ = false;
};

/// A file that occupies space. On a full disk it is deleted, so that the database has the space to commit a removal,
/// which frees more. One thread at a time.
class Reserve {
 public:
  /// Size of the file, enough for the database's log to take the removal of a few hundred rows.
  static constexpr std::int64_t bytes = 256 << 10;

  explicit Reserve(std::filesystem::path file) : file_(std::move(file)) {}
  /// Makes the file where it does not exist and there is enough space.
  void refill() noexcept;
  /// Deletes the file; false where there was none.
  bool release() noexcept;

 private:
  const std::filesystem::path file_;
};

}  // namespace supple::store
