#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "data_folder.h"
#include "postgres.h"
#include "space.h"
#include "supple/base/error.h"
#include "supple/store/shared_store.h"

namespace supple::store {

/// What meshes, jobs and leases of a shared store have in common.
struct SharedStore::Implementation {
  using SteadyClock = std::chrono::steady_clock;

  explicit Implementation(const Options& given);

  void renew_server_lease();
  /// Counts the bytes that all servers have stored.
  void count();
  void add(Category category, std::int64_t bytes);
  Usage usage_now() const;
  /// Whether so many bytes fit by the last count.
  bool fits(Category category, std::int64_t bytes) const;
  /// Makes room for bytes that are about to be written. If there is too little, the oldest results of all servers
  /// expire, then the oldest ones of the owner. `job` is the job that the bytes belong to. Throws "store.quota",
  /// "store.key_quota".
  void make_room(Category category, std::int64_t bytes, const std::string& owner, const std::string& job);
  OwnerUsage owner_usage(const std::string& owner, const std::string& without_job);

  std::optional<MeshRecord> find_mesh(const std::string& id);
  static std::optional<MeshRecord> find_mesh(pqxx::work& transaction, const std::string& id);

  /// Removes the oldest finished jobs, of one owner if `owner` is not empty, until their results have freed so many
  /// bytes. Returns the number of removed jobs.
  std::size_t expire_oldest_results(std::int64_t bytes, const std::string& owner);
  /// Removes the jobs whose sequence numbers a query selects. Their files are deleted after the commit. The definition
  /// is in the only file that calls it.
  template <class... Values>
  std::size_t remove_jobs(const std::string& sequences, const Values&... values);
  /// Removes result files with earlier fencing tokens. A server that was lost between writing the file and the row
  /// leaves such a file. A half-written file is left to quarantine_orphans().
  void remove_results_before(const std::string& id, std::int64_t fencing_token) const;
  /// Whether this server has the lease of the job, and the job is unfinished.
  bool has_lease(const JobRecord& job);
  /// Whether the database has this result of the job, or cannot be asked.
  bool may_be_committed(const JobRecord& job, const std::string& hash);
  /// The job for which an SQL condition with one parameter is true.
  std::optional<JobRecord> find_job(const char* condition, const std::string& value);

  /// Whether a file is missing or differs from its row because another server is removing both. Waits for the commit of
  /// that server. `table` is "meshes" or "jobs".
  bool was_removed(const Error& fault, const std::string& table, const std::string& id);

  /// Moves orphaned files, which no row names, into quarantine. Does this at most once in `orphan_age`. The row of a
  /// younger file may not be committed yet.
  void quarantine_orphans();
  static void remove_file(const std::filesystem::path& file);

  const Options options;
  const DataFolder folder;
  const DataPaths& paths;
  Postgres database;
  const std::string server;  ///< random id of this process
  mutable std::mutex mutex;
  Usage usage_of_all_servers;
  SteadyClock::time_point counted_at{};
  /// Age from which orphaned files are moved, and time between two scans for them.
  const std::chrono::milliseconds orphan_age;
  SteadyClock::time_point next_orphan_scan = SteadyClock::now() + orphan_age;
  std::map<std::string, std::int64_t> unwritten_uses;  ///< times of use of meshes that the database does not have yet
  std::map<std::string, SteadyClock::time_point> confirmed_meshes;  ///< when the database was last seen to have a mesh
};

}  // namespace supple::store
