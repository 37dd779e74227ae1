#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "database.h"

namespace supple::store {

/// Bytes that an owner holds.
struct Holding {
  std::int64_t meshes = 0;
  std::int64_t results = 0;
  std::int64_t requests = 0;  ///< of jobs that have not ended
  std::int64_t total() const { return meshes + results + requests; }
};

/// Who owns which meshes and jobs: rows of a table beside theirs, which go with what they name. What was made where no
/// key was needed has none. Not for several threads at once.
class OwnerTable {
 public:
  enum class Kind { mesh, job };

  /// Makes the table where it does not exist; those of meshes and jobs do. Throws as Database.
  explicit OwnerTable(Database& database);

  /// False where it was one already.
  bool add(Kind kind, const std::string& id, const std::string& owner);
  bool has(Kind kind, const std::string& id, const std::string& owner) const;
  /// False where it was none.
  bool remove(Kind kind, const std::string& id, const std::string& owner);
  std::int64_t count(Kind kind, const std::string& id) const;
  /// What an owner holds without one of its jobs. O(number of things that it owns): two microseconds each.
  Holding holding(const std::string& owner, const std::string& without_job) const;

  /// An expression on rows of "jobs": the owner, of which a job has one at most; empty text where it has none.
  static std::string owner_of_job();

  /// A condition on rows of "meshes" or "jobs": that the parameter (such as "?3") is empty, or one of their owners.
  static std::string condition(Kind kind, std::string_view parameter);

 private:
  Database& database_;
};

}  // namespace supple::store
