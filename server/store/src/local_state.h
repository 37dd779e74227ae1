#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "data_folder.h"
#include "database.h"
#include "file_access.h"
#include "owner_table.h"
#include "recovery.h"
#include "schema.h"
#include "space.h"
#include "supple/base/error.h"
#include "supple/store/clock.h"
#include "supple/store/local_store.h"
#include "supple/store/store_error.h"

namespace supple::store {

/// What the parts of a local store share: its folder, its database and the bytes in it.
///
/// `mutex` guards the database, `owners` and the reserve file. `uses_mutex` guards `unwritten_uses`. In the comments
/// below "the mutex" is the former. The caller of a function that requires a mutex has locked it.
struct LocalState {
  LocalState(const std::filesystem::path& data, const LocalStore::Recovery& recovery, const Quota& quota)
      : folder(data, recovery.warn),
        paths(folder.paths()),
        connection(open_database(folder, database_is_new)),
        database(*connection),
        owners(database),
        usage_counter(paths, quota),
        owner_limit(quota.owner_limit),
        reserve(paths.reserve()) {
    correct_for_clock_jump();
    recover_files(folder, database, recovery, database_is_new);
    try {
      fill_missing_byte_counts(database, paths);
    } catch (const Error& error) {
      folder.warn(std::string("what keys hold cannot be counted before the next start: ") + error.what());
    }
    usage_counter.count();
    reserve.refill();
  }

  /// Ages count the time that has passed, not what the clock says: where the machine's clock was set since an earlier
  /// process, the times of expiry and of use move by as much. After a restart of the machine its clock is trusted.
  void correct_for_clock_jump() {
    constexpr std::int64_t max_drift = 60'000;  // milliseconds; a clock that was set on purpose differs by more
    const auto id = machine_start_id();
    const auto start = machine_start_time();
    std::int64_t jump = 0;
    {
      Statement row(database, "SELECT machine_start_id, machine_start FROM clock");
      const bool same_machine_start = row.step() && !id.empty() && row.text(0) == id;
      if (same_machine_start) jump = start - row.integer(1);
      if (same_machine_start && std::abs(jump) <= max_drift) return;
    }
    try {
      Transaction transaction(database);
      if (jump != 0) {
        Statement(database, "UPDATE jobs SET expires = expires + ? WHERE finished > 0").bind(jump).run();
        Statement(database, "UPDATE meshes SET used = max(used, created) + ?").bind(jump).run();
      }
      database.execute("DELETE FROM clock");
      Statement(database, "INSERT INTO clock VALUES (?, ?)").bind(id).bind(start).run();
      transaction.commit();
    } catch (const Error& error) {
      folder.warn(std::string("the clock cannot be compared with that of an earlier start: ") + error.what());
      return;
    }
    if (jump != 0)
      folder.warn("the clock was set by " + std::to_string(jump / 1000) + " s; what expires does so by as much later");
  }

  /// Requires the mutex.
  std::optional<MeshRecord> find_mesh(const std::string& id) const {
    Statement row(database, "SELECT created, description FROM meshes WHERE id = ?");
    if (!row.bind(id).step()) return std::nullopt;
    return MeshRecord{id, row.integer(0), row.text(1)};
  }

  /// Requires the mutex.
  std::optional<JobRecord> find_job_of_key(const std::string& key) const {
    Statement row(database, "SELECT " + job_columns_to_read() + " FROM jobs WHERE idempotency_key = ?");
    if (!row.bind(key).step()) return std::nullopt;
    return read_job(row);
  }

  /// Adds an owner to a stored mesh. False where `owner` is empty or was one already. Throws "store.key_quota".
  /// Requires the mutex.
  bool add_owner_of_mesh(const std::string& id, const std::string& owner, std::int64_t limit, std::int64_t bytes) {
    if (owner.empty() || owners.has(OwnerTable::Kind::mesh, id, owner)) return false;
    make_room_within_owner_limit(owner, limit, Category::meshes, bytes);
    return owners.add(OwnerTable::Kind::mesh, id, owner);
  }

  /// Requires the mutex.
  std::optional<std::string> request_in_database(const std::string& id) const {
    Statement row(database, "SELECT content FROM requests WHERE job = ?");
    if (!row.bind(id).step()) return std::nullopt;
    return row.text(0);
  }

  /// Counts the bytes of a file before it is written; the oldest results expire where they do not fit. Throws
  /// "store.quota". Must be called without the mutex.
  void claim_space(Category category, std::int64_t bytes) {
    while (const auto excess = usage_counter.try_add(category, bytes)) {
      const std::lock_guard lock(mutex);
      if (expire_oldest_results(excess, {}) == 0) usage_counter.refuse(category, bytes);
    }
  }

  /// Limit for the bytes of an owner; 0: no limit. Must be called without the mutex: the object that knows the limits
  /// has one too.
  std::int64_t limit_of(const std::string& owner) const {
    return owner_limit && !owner.empty() ? owner_limit(owner) : 0;
  }

  /// Lets the oldest results of the owner expire where so many new bytes would exceed its limit. `job` is the job that
  /// the bytes belong to; its other bytes do not count. Throws "store.key_quota". Requires the mutex.
  void make_room_within_owner_limit(const std::string& owner, std::int64_t limit, Category category, std::int64_t bytes,
                                    const std::string& job = {}) {
    if (limit <= 0) return;
    const auto owner_usage = owners.owner_usage(owner, job);
    const auto excess = owner_usage.total() + bytes - limit;
    // Nothing is removed if the bytes would not even fit without all results.
    if (excess > owner_usage.results) refuse_owner(owner, owner_usage, category, bytes, limit);
    if (excess > 0) expire_oldest_results(excess, owner);
  }

  /// Removes the oldest finished jobs, of one owner if `owner` is not empty, until their results have freed so many
  /// bytes. Returns the number of removed jobs. Requires the mutex.
  std::size_t expire_oldest_results(std::int64_t bytes, const std::string& owner) {
    std::vector<std::string> oldest;
    {
      std::int64_t freed = 0;
      Statement rows(database, "SELECT id FROM jobs WHERE finished > 0 AND result_hash <> '' AND " +
                                   OwnerTable::condition(OwnerTable::Kind::job, "?1") + " ORDER BY finished, sequence");
      rows.bind(owner);
      while (freed < bytes && rows.step()) {
        oldest.push_back(rows.text(0));
        freed += bytes_of(paths.result(oldest.back()));
      }
    }
    remove_jobs(oldest);
    if (!oldest.empty()) {
      folder.warn(std::to_string(oldest.size()) + " finished jobs " +
                  (owner.empty() ? "" : "of the key " + owner + " ") + "have expired to make room for others (" +
                  (owner.empty() ? "--max-store" : "--max-stored") + ")");
    }
    return oldest.size();
  }

  /// Runs a removal, and once more without the reserve file if the disk is full: the commit needs space. Requires the
  /// mutex.
  template <class Removal>
  auto with_reserve(Removal removal) {
    try {
      return removal();
    } catch (const StoreFull&) {
      if (!reserve.release()) throw;
    }
    return removal();
  }

  /// Removes jobs. Their files are deleted last: if the commit fails, the rows still need their results. Requires the
  /// mutex.
  void remove_jobs(const std::vector<std::string>& ids) {
    constexpr std::size_t batch = 200;  // jobs whose commit fits into the reserve file
    for (std::size_t begin = 0; begin < ids.size(); begin += batch) {
      const auto end = std::min(ids.size(), begin + batch);
      with_reserve([&] {
        Transaction transaction(database);
        for (auto i = begin; i < end; ++i) delete_row(ids[i]);
        transaction.commit();
      });
      for (auto i = begin; i < end; ++i) delete_files(ids[i]);
      reserve.refill();
    }
  }

  /// Deletes the row of a job; false where there was none. Requires the mutex.
  bool delete_row(const std::string& id) const {
    return Statement(database, "DELETE FROM jobs WHERE id = ?").bind(id).run() > 0;
  }
  /// Deletes the files of a job. The next start finds those that cannot be deleted.
  void delete_files(const std::string& id) {
    delete_file(Category::results, paths.result(id));
    delete_file(Category::requests, paths.request(id));
  }
  void delete_file(Category category, const std::filesystem::path& file) {
    const auto bytes = bytes_of(file);
    std::error_code ignored;
    if (std::filesystem::remove(file, ignored)) usage_counter.add(category, -bytes);
  }

  /// Counts the bytes of a file, then writes it.
  void write_counted_file(Category category, const std::filesystem::path& file,
                          std::initializer_list<std::string_view> pieces) {
    std::int64_t bytes = 0;
    for (const auto piece : pieces) bytes += static_cast<std::int64_t>(piece.size());
    claim_space(category, bytes);
    SpaceClaim claim(usage_counter, category, bytes);
    write_stored_file(file, pieces);
    claim.commit();
  }

  /// Writes the times of use of meshes to the database. Requires both mutexes, or that no other thread uses the store.
  void write_mesh_uses() {
    if (unwritten_uses.empty()) return;
    const UnsyncedCommits unsynced(database);
    Transaction transaction(database);
    for (const auto& [id, when] : unwritten_uses)
      Statement(database, "UPDATE meshes SET used = ? WHERE id = ?").bind(when).bind(id).run();
    transaction.commit();
    unwritten_uses.clear();
  }

  const DataFolder folder;
  const DataPaths& paths;
  bool database_is_new = false;
  mutable std::mutex mutex;
  const std::unique_ptr<Database> connection;
  Database& database;
  OwnerTable owners;
  UsageCounter usage_counter;
  const std::function<std::int64_t(const std::string& owner)> owner_limit;
  Reserve reserve;
  mutable std::mutex uses_mutex;
  std::map<std::string, std::int64_t> unwritten_uses;  ///< times of use of meshes that the database does not have yet
};

std::unique_ptr<MeshStore> make_local_meshes(LocalState& state);
std::unique_ptr<FamilyStore> make_local_families(LocalState& state);
std::unique_ptr<JobStore> make_local_jobs(LocalState& state);
std::unique_ptr<BlobStore> make_local_blobs(LocalState& state);

}  // namespace supple::store
