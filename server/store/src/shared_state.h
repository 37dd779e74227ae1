#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "data_folder.h"
#include "postgres.h"
#include "space.h"
#include "supple/store/shared_store.h"

namespace supple::store {

/// What the parts of a shared store (SharedStore) have in common in one of the servers that use it.
struct SharedState {
  using SteadyClock = std::chrono::steady_clock;

  explicit SharedState(const SharedStore::Options& given);

  void renew_server_lease();
  /// Gives up the leases of this server's jobs, so that others can take them at once.
  void end_leases() noexcept;
  /// Runs a transaction that also writes the times of use of meshes.
  template <class Work>
  auto transaction_with_mesh_uses(const Work& work);
  /// Counts the bytes that all servers have stored.
  void count();
  bool is_recount_due() const;
  void add(Category category, std::int64_t bytes);
  Usage usage_now() const;
  /// Whether `bytes` more fit into the store, by the last count and what this server has added since.
  bool fits(Category category, std::int64_t bytes) const;
  /// Makes room for `bytes` that are about to be written. The oldest results expire, until the bytes fit into the limit
  /// of the store, and then the oldest ones of `owner`, until they fit into its own limit. The other bytes of `job`, to
  /// which they belong, do not count for the owner. Throws "store.quota", "store.key_quota".
  void make_room(Category category, std::int64_t bytes, const std::string& owner, const std::string& job);
  OwnerUsage owner_usage(const std::string& owner, const std::string& without_job);

  std::optional<MeshRecord> find_mesh(const std::string& id);
  static std::optional<MeshRecord> find_mesh(pqxx::work& transaction, const std::string& id);

  /// Removes the oldest finished jobs, of one owner if `owner` is not empty, until their results have freed so many
  /// bytes. Returns the number of removed jobs.
  std::size_t expire_oldest_results(std::int64_t bytes, const std::string& owner);
  /// Removes the jobs whose sequence numbers a query selects. Their files are deleted after the commit.
  template <class... Values>
  std::size_t remove_jobs(const std::string& sequences, const Values&... values);
  /// Removes result files with earlier fencing tokens. A server that was lost between writing the file and the row
  /// leaves such a file. A half-written file is left to quarantine_orphans().
  void remove_results_before(const std::string& id, std::int64_t fencing_token) const;
  /// The job for which an SQL condition with one parameter is true.
  std::optional<JobRecord> find_job(const char* condition, const std::string& value);

  /// Whether a file that is missing or differs from its row is so because another server is removing both. Waits for
  /// the commit of that server. `table` is "meshes" or "jobs".
  bool was_removed(const std::string& table, const std::string& id);

  /// Moves files that no row names into quarantine, and deletes half-written ones, if they are older than `orphan_age`.
  /// The row of a younger file may not be committed yet. Does this at most once in `orphan_age`.
  void quarantine_orphans();
  static void remove_file(const std::filesystem::path& file);

  const SharedStore::Options options;
  const DataFolder folder;
  const DataPaths& paths;
  Postgres database;
  const std::string server;  ///< random id of this process
  /// Age from which orphaned files are moved, and time between two scans for them.
  const std::chrono::milliseconds orphan_age;
  // The mutex guards the following members. No transaction runs while it is locked.
  mutable std::mutex mutex;
  Usage usage_of_all_servers;
  SteadyClock::time_point counted_at{};
  SteadyClock::time_point next_orphan_scan = SteadyClock::now() + orphan_age;
  std::map<std::string, std::int64_t> unwritten_uses;  ///< times of use that the database does not have yet, by mesh
  std::map<std::string, SteadyClock::time_point> confirmed_meshes;  ///< when the database was last seen to have a mesh
};

template <class Work>
auto SharedState::transaction_with_mesh_uses(const Work& work) {
  std::map<std::string, std::int64_t> uses;
  {
    const std::lock_guard lock(mutex);
    uses.swap(unwritten_uses);
  }
  try {
    return database.transaction([&](pqxx::work& transaction) {
      for (const auto& [id, when] : uses)
        transaction.exec_params("UPDATE meshes SET used = greatest(used, $2) WHERE id = $1", id, when);
      return work(transaction);
    });
  } catch (...) {
    const std::lock_guard lock(mutex);
    for (const auto& [id, when] : uses) unwritten_uses.emplace(id, when);
    throw;
  }
}

template <class... Values>
std::size_t SharedState::remove_jobs(const std::string& sequences, const Values&... values) {
  struct Removed {
    std::string id;
    std::int64_t fencing_token;
    std::int64_t bytes;
  };
  const auto removed = database.transaction([&](pqxx::work& transaction) {
    std::vector<Removed> jobs;
    for (const pqxx::row& row : transaction.exec_params(
             "DELETE FROM jobs WHERE sequence IN (" + sequences + ") RETURNING id, hold, bytes", values...))
      jobs.push_back({row[0].c_str(), row[1].as<std::int64_t>(), row[2].as<std::int64_t>()});
    return jobs;
  });
  for (const auto& job : removed) {
    remove_results_before(job.id, job.fencing_token + 1);
    remove_file(paths.request(job.id));
    add(Category::results, -job.bytes);
  }
  return removed.size();
}

std::unique_ptr<MeshStore> make_shared_meshes(SharedState& state);
std::unique_ptr<FamilyStore> make_shared_families(SharedState& state);
std::unique_ptr<JobStore> make_shared_jobs(SharedState& state);
std::unique_ptr<BlobStore> make_shared_blobs(SharedState& state);
std::unique_ptr<LeaseStore> make_shared_leases(SharedState& state);

}  // namespace supple::store
