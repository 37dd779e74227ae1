#pragma once

#include <cstdint>
#include <mutex>
#include <string_view>

#include "data_folder.h"
#include "owner_table.h"
#include "supple/store/store.h"

namespace supple::store {

/// What the files of a store are.
enum class Part { meshes, results, requests };

/// By how many bytes new ones are too many for the limit of all data, which is what has to go first. Throws
/// ProblemError "store.quota" where nothing that could go makes room for them, and for meshes beyond their own limit.
std::int64_t bytes_too_many(const Usage& usage, Part part, std::int64_t bytes);

/// Throws ProblemError "store.quota" for bytes that are too many.
[[noreturn]] void refuse_store(const Usage& usage, Part part, std::int64_t bytes);

/// Counts the bytes of a data folder: at the start by looking at every file, from then on by what is written and
/// removed. Any thread may call.
class Space {
 public:
  Space(const Places& places, const Quota& quota) : places_(places), quota_(quota) {}

  /// Counts every file anew, O(number of files).
  void count();
  /// Counts what is in quarantine, which whoever runs the server may empty at any time.
  void count_quarantine();
  void add(Part part, std::int64_t bytes);

  /// Adds so many bytes, or adds nothing and returns by how many they are too many for the quota of all data, which is
  /// what has to go first. Throws ProblemError "store.quota" where nothing that could go makes room for them.
  std::int64_t try_add(Part part, std::int64_t bytes);
  /// Throws ProblemError "store.quota" for bytes that are too many.
  [[noreturn]] void refuse(Part part, std::int64_t bytes) const { refuse_store(usage(), part, bytes); }

  Usage usage() const;

 private:
  std::int64_t& counter(Part part);
  /// Under the mutex.
  Usage measured() const;

  const Places places_;
  const Quota quota_;
  mutable std::mutex mutex_;
  Usage counted_;
};

/// Throws ProblemError "store.key_quota": what is new would take an owner beyond its limit.
[[noreturn]] void refuse_owner(const std::string& owner, const Holding& holding, Part part, std::int64_t bytes,
                               std::int64_t limit);

/// Bytes that a file is about to take: given back unless they are kept.
class TakenSpace {
 public:
  TakenSpace(Space& space, Part part, std::int64_t bytes) : space_(space), part_(part), bytes_(bytes) {}
  ~TakenSpace() {
    if (!kept_) space_.add(part_, -bytes_);
  }
  TakenSpace(const TakenSpace&) = delete;
  TakenSpace& operator=(const TakenSpace&) = delete;
  void keep() { kept_ = true; }

 private:
  Space& space_;
  const Part part_;
  const std::int64_t bytes_;
  bool kept_ = false;
};

/// A file that takes space so that it can be given back: on a full disk a removal can be committed in its place, and
/// then there is space. One thread at a time.
class Reserve {
 public:
  /// Enough for the database's log to take the removal of a few hundred rows.
  static constexpr std::int64_t bytes = 256 << 10;

  explicit Reserve(std::filesystem::path file) : file_(std::move(file)) {}
  /// Takes the space where it is not taken and there is enough of it.
  void take() noexcept;
  /// False where there was none to give.
  bool give_back() noexcept;

 private:
  const std::filesystem::path file_;
};

}  // namespace supple::store
