#include "supple/store/local_store.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <system_error>

#include "checked_content.h"
#include "data_folder.h"
#include "database.h"
#include "file_access.h"
#include "owner_table.h"
#include "record_file.h"
#include "recovery.h"
#include "schema.h"
#include "space.h"
#include "supple/base/error.h"

namespace supple::store {

namespace fs = std::filesystem;

struct LocalStore::Implementation {
  Implementation(const fs::path& data, const Recovery& recovery, const Quota& quota)
      : folder(data, recovery.warn),
        paths(folder.paths()),
        connection(open_database(folder, database_is_new)),
        database(*connection),
        owners(database),
        usage_counter(paths, quota),
        quota_of_owner(quota.of_owner),
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
    const auto start = machine_start();
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
    return quota_of_owner && !owner.empty() ? quota_of_owner(owner) : 0;
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
    } catch (const Error& error) {
      if (error.code() != "store.full" || !reserve.release()) throw;
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

  bool delete_row(const std::string& id) const {
    return Statement(database, "DELETE FROM jobs WHERE id = ?").bind(id).run() > 0;
  }
  /// Deletes the files of a job. The next start finds those that cannot be deleted.
  void delete_files(const std::string& id) {
    delete_file(Category::results, paths.result(id));
    delete_file(Category::requests, paths.request(id));
  }
  void delete_file(Category category, const fs::path& file) {
    const auto bytes = bytes_of(file);
    std::error_code ignored;
    if (fs::remove(file, ignored)) usage_counter.add(category, -bytes);
  }

  /// Counts the bytes of a file, then writes it.
  void write_counted_file(Category category, const fs::path& file, std::initializer_list<std::string_view> pieces) {
    std::int64_t bytes = 0;
    for (const auto piece : pieces) bytes += static_cast<std::int64_t>(piece.size());
    claim_space(category, bytes);
    SpaceClaim claim(usage_counter, category, bytes);
    write_stored_file(file, pieces);
    claim.commit();
  }

  /// Writes the times of use of meshes to the database. Requires the mutex.
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
  const std::function<std::int64_t(const std::string& owner)> quota_of_owner;
  Reserve reserve;
  mutable std::mutex uses_mutex;
  std::map<std::string, std::int64_t> unwritten_uses;  ///< times of use of meshes that the database does not have yet
};

LocalStore::LocalStore(const fs::path& folder, const Recovery& recovery, const Quota& quota) {
  try {
    implementation_ = std::make_unique<Implementation>(folder, recovery, quota);
  } catch (const fs::filesystem_error& error) {
    throw Error("store.unavailable",
                "The data folder " + folder.string() + " cannot be used: " + error.code().message() + ".");
  }
}
LocalStore::~LocalStore() {
  if (!implementation_) return;
  try {
    implementation_->write_mesh_uses();
  } catch (const Error&) {
    // The times of use are lost, and these meshes may expire too early.
  }
}

std::pair<MeshRecord, bool> LocalStore::add_mesh(const std::string& ply, const DescribeMesh& describe,
                                                 const std::string& owner) {
  auto& self = *implementation_;
  const auto bytes = static_cast<std::int64_t>(ply.size());
  const auto limit = self.limit_of(owner);
  MeshRecord record;
  record.id = sha256(ply);
  if (mesh(record.id)) {
    use_mesh(record.id);
    // Uploading again repairs a file that has been damaged.
    try {
      open_mesh_content(record.id);
    } catch (const Error&) {
      write_stored_file(self.paths.mesh(record.id), {ply});
      self.usage_counter.count();  // recounts, for the damaged file may have had another size
    }
    const std::lock_guard lock(self.mutex);
    if (auto existing = self.find_mesh(record.id))
      return {std::move(*existing), self.add_owner_of_mesh(record.id, owner, limit, bytes)};
    // The last owner has removed the mesh meanwhile, so that it is a new one.
  }
  record.created = now_milliseconds();
  record.description = describe(record.id, record.created);
  {
    const std::lock_guard lock(self.mutex);  // checks the owner's limit before results of others expire
    self.make_room_within_owner_limit(owner, limit, Category::meshes, bytes);
  }
  self.claim_space(Category::meshes, bytes);
  SpaceClaim claim(self.usage_counter, Category::meshes, bytes);
  // The mutex is held from here on, so that the mesh cannot be removed between writing its file and its row.
  const std::lock_guard lock(self.mutex);
  if (auto existing = self.find_mesh(record.id))
    return {std::move(*existing), self.add_owner_of_mesh(record.id, owner, limit, bytes)};
  self.make_room_within_owner_limit(owner, limit, Category::meshes, bytes);
  write_stored_file(self.paths.mesh(record.id), {ply});
  try {
    Transaction transaction(self.database);
    insert_mesh(self.database, record, bytes);
    if (!owner.empty()) self.owners.add(OwnerTable::Kind::mesh, record.id, owner);
    transaction.commit();
  } catch (...) {
    std::error_code ignored;
    fs::remove(self.paths.mesh(record.id), ignored);
    throw;
  }
  claim.commit();
  return {std::move(record), true};
}

std::optional<MeshRecord> LocalStore::mesh(const std::string& id) const {
  const std::lock_guard lock(implementation_->mutex);
  return implementation_->find_mesh(id);
}

std::vector<MeshRecord> LocalStore::meshes(std::size_t limit, const std::string& after,
                                           const std::string& owner) const {
  const std::lock_guard lock(implementation_->mutex);
  std::vector<MeshRecord> records;
  Statement rows(implementation_->database,
                 "SELECT id, created, description FROM meshes WHERE (?1 = '' OR sequence < "
                 "(SELECT sequence FROM meshes WHERE id = ?1)) AND " +
                     OwnerTable::condition(OwnerTable::Kind::mesh, "?3") + " ORDER BY sequence DESC LIMIT ?2");
  rows.bind(after).bind(static_cast<std::int64_t>(limit)).bind(owner);
  while (rows.step()) records.push_back({rows.text(0), rows.integer(1), rows.text(2)});
  return records;
}

std::string LocalStore::mesh_content(const std::string& id, const CancellationToken& cancellation) const {
  if (!mesh(id)) throw Error("mesh.not_found", "There is no mesh " + id + ".");
  auto bytes = read_file(implementation_->paths.mesh(id), cancellation);
  if (sha256(bytes, cancellation) != id)
    throw Error("store.corrupted", "The stored file " + id + ".ply has changed since it was written.");
  return bytes;
}

OpenContent LocalStore::open_mesh_content(const std::string& id, const CancellationToken& cancellation) const {
  if (!mesh(id)) throw Error("mesh.not_found", "There is no mesh " + id + ".");
  return open_checked(implementation_->paths.mesh(id), {}, id, cancellation);
}

bool LocalStore::owns_mesh(const std::string& id, const std::string& owner) const {
  const std::lock_guard lock(implementation_->mutex);
  return implementation_->owners.has(OwnerTable::Kind::mesh, id, owner);
}

bool LocalStore::is_last_owner_of_mesh(const std::string& id, const std::string& owner) const {
  const std::lock_guard lock(implementation_->mutex);
  const auto& owners = implementation_->owners;
  return owners.has(OwnerTable::Kind::mesh, id, owner) && owners.count(OwnerTable::Kind::mesh, id) == 1;
}

bool LocalStore::remove_mesh(const std::string& id, const std::string& owner) {
  auto& self = *implementation_;
  const std::lock_guard lock(self.mutex);
  if (!owner.empty()) {
    if (!self.owners.has(OwnerTable::Kind::mesh, id, owner)) return false;
    if (self.owners.count(OwnerTable::Kind::mesh, id) > 1) return self.owners.remove(OwnerTable::Kind::mesh, id, owner);
  }
  const int rows =
      self.with_reserve([&] { return Statement(self.database, "DELETE FROM meshes WHERE id = ?").bind(id).run(); });
  if (rows == 0) return false;
  self.delete_file(Category::meshes, self.paths.mesh(id));  // if it stays, the next start makes a row for it
  self.reserve.refill();
  return true;
}

void LocalStore::use_mesh(const std::string& id) const {
  const std::lock_guard lock(implementation_->uses_mutex);
  implementation_->unwritten_uses[id] = now_milliseconds();
}

std::vector<std::string> LocalStore::remove_unused_meshes(std::int64_t before) {
  auto& self = *implementation_;
  std::vector<std::string> ids;
  const std::scoped_lock lock(self.mutex, self.uses_mutex);
  self.write_mesh_uses();
  {
    Statement rows(self.database,
                   "SELECT id FROM meshes WHERE max(created, used) < ? AND id NOT IN "
                   "(SELECT mesh FROM jobs WHERE finished = 0)");
    for (rows.bind(before); rows.step();) ids.push_back(rows.text(0));
  }
  for (const auto& id : ids) {
    self.with_reserve([&] { Statement(self.database, "DELETE FROM meshes WHERE id = ?").bind(id).run(); });
    self.delete_file(Category::meshes, self.paths.mesh(id));
  }
  self.reserve.refill();
  return ids;
}

std::string LocalStore::keep_request(const JobRecord& job, const JobRequest& request, std::string_view body) {
  auto& self = *implementation_;
  auto content = request_file(job, request).header(sha256(body));
  if (const auto limit = self.limit_of(job.owner); limit > 0) {
    const std::lock_guard lock(self.mutex);
    self.make_room_within_owner_limit(job.owner, limit, Category::requests,
                                      static_cast<std::int64_t>(content.size() + body.size()));
  }
  if (body.size() > max_request_in_database) {
    self.write_counted_file(Category::requests, self.paths.request(job.id), {content, body});
    return {};
  }
  content += body;
  const auto bytes = static_cast<std::int64_t>(content.size());
  self.claim_space(Category::requests, bytes);
  SpaceClaim claim(self.usage_counter, Category::requests, bytes);
  write_unsynced_file(self.paths.request(job.id), {content});
  claim.commit();
  return content;
}

void LocalStore::drop_request(const std::string& id) {
  implementation_->delete_file(Category::requests, implementation_->paths.request(id));
}

bool LocalStore::has_request(const std::string& id) const {
  {
    const std::lock_guard lock(implementation_->mutex);
    if (implementation_->request_in_database(id)) return true;
  }
  std::error_code ignored;
  return fs::exists(implementation_->paths.request(id), ignored);
}

StoredRequest LocalStore::job_request(const std::string& id) const {
  std::unique_lock lock(implementation_->mutex);
  auto in_database = implementation_->request_in_database(id);
  lock.unlock();
  auto bytes = in_database ? *std::move(in_database) : read_file(implementation_->paths.request(id));
  const auto file = RecordFile::parse(request_kind, bytes, id + ".request");
  bytes.erase(0, file.header_size());
  if (sha256(bytes) != file.body_hash()) throw_corrupted(id + ".request");
  return {request_of(file), std::move(bytes)};
}

bool LocalStore::add_job(const JobRecord& job, const std::string& request) {
  auto& self = *implementation_;
  auto& database = self.database;
  const auto limit = self.limit_of(job.owner);
  const auto bytes = request.empty() ? bytes_of(self.paths.request(job.id)) : static_cast<std::int64_t>(request.size());
  const std::lock_guard lock(self.mutex);
  if (!job.idempotency_key.empty() && self.find_job_of_key(job.idempotency_key)) return false;
  self.make_room_within_owner_limit(job.owner, limit, Category::requests, bytes, job.id);
  Transaction transaction(database);
  insert_job(database, job, bytes, self.owners);
  if (!request.empty())
    Statement(database, "INSERT INTO requests (job, content) VALUES (?, ?)").bind(job.id).bind_bytes(request).run();
  transaction.commit();
  return true;
}

bool LocalStore::note_progress(const JobRecord& job) {
  const std::lock_guard lock(implementation_->mutex);
  auto& database = implementation_->database;
  const UnsyncedCommits unsynced(database);
  Statement(database, "UPDATE jobs SET state = ?, started = ?, attempts = ? WHERE id = ? AND finished = 0")
      .bind(state_name(job.state))
      .bind(job.started)
      .bind(static_cast<std::int64_t>(job.attempts))
      .bind(job.id)
      .run();
  return true;
}

bool LocalStore::finish_job(const JobRecord& job, const Result* result) {
  auto& self = *implementation_;
  const auto path = self.paths.result(job.id);
  const auto limit = result ? self.limit_of(job.owner) : 0;
  bool updated = false;
  try {
    ResultFile file;
    const auto make_room = [&] {
      self.make_room_within_owner_limit(job.owner, limit, Category::results, file.bytes, job.id);
    };
    if (result) {
      file.hash = sha256(result->body);
      const auto header = result_file(job, *result).header(file.hash);
      file.bytes = static_cast<std::int64_t>(header.size() + result->body.size());
      if (limit > 0) {
        const std::lock_guard lock(self.mutex);
        make_room();
      }
      self.write_counted_file(Category::results, path, {header, result->body});
    }
    const std::lock_guard lock(self.mutex);
    make_room();  // other jobs of the owner may have ended meanwhile
    updated = update_ended_job(self.database, job, result, file);
  } catch (...) {
    // A result without a row would occupy space that is needed to store why the job failed.
    if (result) self.delete_file(Category::results, path);
    throw;
  }
  if (!updated) self.delete_file(Category::results, path);
  drop_request(job.id);
  return updated;
}

std::optional<JobRecord> LocalStore::job_of_key(const std::string& key) const {
  const std::lock_guard lock(implementation_->mutex);
  return implementation_->find_job_of_key(key);
}

std::optional<JobRecord> LocalStore::job(const std::string& id) const {
  const std::lock_guard lock(implementation_->mutex);
  Statement row(implementation_->database, "SELECT " + job_columns_to_read() + " FROM jobs WHERE id = ?");
  if (!row.bind(id).step()) return std::nullopt;
  return read_job(row);
}

std::vector<JobRecord> LocalStore::jobs(const std::vector<JobState>& states, std::size_t limit,
                                        const std::string& after, const std::string& owner) const {
  std::string names;  // constants of this program, which need no escaping in SQL
  for (const auto state : states) names.append(names.empty() ? "'" : ", '").append(state_name(state)).append("'");
  const std::lock_guard lock(implementation_->mutex);
  Statement rows(implementation_->database,
                 "SELECT " + job_columns_to_read() +
                     " FROM jobs WHERE (?1 = '' OR sequence < (SELECT sequence FROM jobs WHERE id = ?1))" +
                     (states.empty() ? "" : " AND state IN (" + names + ")") + " AND " +
                     OwnerTable::condition(OwnerTable::Kind::job, "?3") + " ORDER BY sequence DESC LIMIT ?2");
  rows.bind(after).bind(static_cast<std::int64_t>(limit)).bind(owner);
  std::vector<JobRecord> records;
  while (rows.step()) records.push_back(read_job(rows));
  return records;
}

bool LocalStore::owns_job(const std::string& id, const std::string& owner) const {
  const std::lock_guard lock(implementation_->mutex);
  return implementation_->owners.has(OwnerTable::Kind::job, id, owner);
}

StoredResult LocalStore::job_result(const std::string& id) const {
  Result row_of_result;
  std::string hash;
  {
    const std::lock_guard lock(implementation_->mutex);
    Statement row(implementation_->database, "SELECT result_type, result_headers, result_hash FROM jobs WHERE id = ?");
    if (!row.bind(id).step()) throw Error("job.not_found", "There is no job " + id + ".");
    row_of_result.content_type = row.text(0);
    split_headers(row.text(1), row_of_result);
    hash = row.text(2);
  }
  return {std::move(row_of_result.content_type), std::move(row_of_result.headers),
          open_checked(implementation_->paths.result(id), result_kind, hash, {})};
}

bool LocalStore::remove_job(const std::string& id) {
  auto& self = *implementation_;
  const std::lock_guard lock(self.mutex);
  if (!self.with_reserve([&] { return self.delete_row(id); })) return false;
  self.delete_files(id);
  self.reserve.refill();
  return true;
}

std::vector<JobRecord> LocalStore::unfinished_jobs() const {
  const std::lock_guard lock(implementation_->mutex);
  Statement rows(implementation_->database, "SELECT " + job_columns_to_read() +
                                                " FROM jobs WHERE state IN ('accepted', 'running') ORDER BY sequence");
  std::vector<JobRecord> records;
  while (rows.step()) records.push_back(read_job(rows));
  return records;
}

std::size_t LocalStore::remove_expired_jobs(std::int64_t now, std::size_t max_count) {
  auto& self = *implementation_;
  self.usage_counter.count_quarantine();
  const std::lock_guard lock(self.mutex);
  std::vector<std::string> ids;
  {
    Statement rows(self.database,
                   "SELECT id FROM jobs WHERE finished > 0 AND (expires <= ?1 OR sequence NOT IN "
                   "(SELECT sequence FROM jobs WHERE finished > 0 ORDER BY sequence DESC LIMIT ?2))");
    rows.bind(now).bind(static_cast<std::int64_t>(max_count));
    while (rows.step()) ids.push_back(rows.text(0));
  }
  self.remove_jobs(ids);
  self.reserve.refill();
  return ids.size();
}

void LocalStore::take_reserve() {
  const std::lock_guard lock(implementation_->mutex);
  implementation_->reserve.refill();
}

Usage LocalStore::usage() const { return implementation_->usage_counter.usage(); }

}  // namespace supple::store
