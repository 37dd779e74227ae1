#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "database.h"

namespace supple::store {

/// Bytes of what an owner has stored.
struct OwnerUsage {
  std::int64_t meshes = 0;
  std::int64_t families = 0;
  std::int64_t results = 0;
  std::int64_t requests = 0;  ///< requests of unfinished jobs
  std::int64_t total() const { return meshes + families + results + requests; }
};

/// The owners of meshes and jobs, in a table of their own. Its rows are removed with the mesh or job that they name.
/// What was made where no key was needed has no owner. Families, which have one owner each, name it in their rows. Not
/// for several threads at once.
class OwnerTable {
 public:
  enum class Kind { mesh, job };

  /// Makes the table where it does not exist. The tables of meshes, families and jobs must exist. Throws as Database
  /// does.
  explicit OwnerTable(Database& database);

  /// Adds an owner; false where it was one already.
  bool add(Kind kind, const std::string& id, const std::string& owner);
  bool has(Kind kind, const std::string& id, const std::string& owner) const;
  /// Removes an owner; false where it was none.
  bool remove(Kind kind, const std::string& id, const std::string& owner);
  std::int64_t count(Kind kind, const std::string& id) const;
  /// Bytes of an owner, without those of the job `without_job`. O(number of meshes, families and jobs that it
  /// owns): two microseconds each.
  OwnerUsage owner_usage(const std::string& owner, const std::string& without_job) const;

  /// An SQL expression on rows of "jobs": the only owner of a job, or empty text where it has none.
  static std::string owner_of_job();

  /// An SQL condition on rows of "meshes" or "jobs": that the parameter (such as "?3") is empty, or one of their
  /// owners.
  static std::string condition(Kind kind, std::string_view parameter);

 private:
  Database& database_;
};

}  // namespace supple::store
