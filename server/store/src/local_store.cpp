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
        places(folder.places()),
        connection(open_database(folder, database_is_new)),
        database(*connection),
        owners(database),
        space(places, quota),
        quota_of_owner(quota.of_owner),
        reserve(places.reserve()) {
    follow_clock();
    recover_files(folder, database, recovery, database_is_new);
    try {
      count_bytes_of_rows(database, places);
    } catch (const Error& error) {
      folder.warn(std::string("what keys hold cannot be counted before the next start: ") + error.what());
    }
    space.count();
    reserve.take();
  }

  /// Ages are the time that has passed, not what clocks say: where the machine's clock was set since an earlier
  /// process, what expires does so later, or earlier, by as much. After a start of the machine only its clock can tell.
  void follow_clock() {
    constexpr std::int64_t noise = 60'000;  // milliseconds by which nobody sets a clock who means it
    const auto id = machine_start_id();
    const auto start = machine_start();
    std::int64_t jump = 0;
    {
      Statement row(database, "SELECT machine_start_id, machine_start FROM clock");
      const bool same_machine_start = row.step() && !id.empty() && row.text(0) == id;
      if (same_machine_start) jump = start - row.integer(1);
      if (same_machine_start && std::abs(jump) <= noise) return;
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

  /// Under the mutex.
  std::optional<JobRecord> find_job_of_key(const std::string& key) const {
    Statement row(database, "SELECT " + job_columns_to_read() + " FROM jobs WHERE idempotency_key = ?");
    if (!row.bind(key).step()) return std::nullopt;
    return read_job(row);
  }

  /// Under the mutex: makes the owner one of those of a mesh that is stored. False where none is named, and where it
  /// was one already. Throws "store.key_quota".
  bool own_mesh(const std::string& id, const std::string& owner, std::int64_t limit, std::int64_t bytes) {
    if (owner.empty() || owners.has(OwnerTable::Kind::mesh, id, owner)) return false;
    make_room_of_owner(owner, limit, Part::meshes, bytes);
    return owners.add(OwnerTable::Kind::mesh, id, owner);
  }

  std::optional<std::string> request_in_database(const std::string& id) const {
    Statement row(database, "SELECT content FROM requests WHERE job = ?");
    if (!row.bind(id).step()) return std::nullopt;
    return row.text(0);
  }

  /// Takes the space of a file that is about to be written; old results go where it is needed. Throws "store.quota".
  /// Not under the mutex.
  void take(Part part, std::int64_t bytes) {
    while (const auto too_many = space.try_add(part, bytes)) {
      const std::lock_guard lock(mutex);
      if (expire_oldest_results(too_many, {}) == 0) space.refuse(part, bytes);
    }
  }

  /// Bytes that an owner may hold; 0: no limit. Not under the mutex, for whoever keeps the limits has one too.
  std::int64_t limit_of(const std::string& owner) const {
    return quota_of_owner && !owner.empty() ? quota_of_owner(owner) : 0;
  }

  /// Under the mutex, before a row of so many bytes is written: the owner's oldest results go where it would hold more
  /// than its limit. `job` is the one that the bytes are of, whose others go. Throws "store.key_quota".
  void make_room_of_owner(const std::string& owner, std::int64_t limit, Part part, std::int64_t bytes,
                          const std::string& job = {}) {
    if (limit <= 0) return;
    const auto holding = owners.holding(owner, job);
    const auto too_many = holding.total() + bytes - limit;
    // Results are not thrown away for what would not fit without them either.
    if (too_many > holding.results) refuse_owner(owner, holding, part, bytes, limit);
    if (too_many > 0) expire_oldest_results(too_many, owner);
  }

  /// Under the mutex: removes the oldest finished jobs, of an owner alone where one is named, until their results have
  /// freed so many bytes. Returns how many there were.
  std::size_t expire_oldest_results(std::int64_t bytes, const std::string& owner) {
    std::vector<std::string> oldest;
    {
      std::int64_t freed = 0;
      Statement rows(database, "SELECT id FROM jobs WHERE finished > 0 AND result_hash <> '' AND " +
                                   OwnerTable::condition(OwnerTable::Kind::job, "?1") + " ORDER BY finished, sequence");
      rows.bind(owner);
      while (freed < bytes && rows.step()) {
        oldest.push_back(rows.text(0));
        freed += bytes_of(places.result(oldest.back()));
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

  /// Under the mutex: a removal needs space before it makes some.
  template <class Removal>
  auto with_reserve(Removal removal) {
    try {
      return removal();
    } catch (const Error& error) {
      if (error.code() != "store.full" || !reserve.give_back()) throw;
    }
    return removal();
  }

  /// Under the mutex. The files go last, for a row that stays because the commit failed must still have its result.
  void remove_jobs(const std::vector<std::string>& ids) {
    constexpr std::size_t batch = 200;  // whose commit fits into the reserve
    for (std::size_t begin = 0; begin < ids.size(); begin += batch) {
      const auto end = std::min(ids.size(), begin + batch);
      with_reserve([&] {
        Transaction transaction(database);
        for (auto i = begin; i < end; ++i) delete_row(ids[i]);
        transaction.commit();
      });
      for (auto i = begin; i < end; ++i) delete_files(ids[i]);
      reserve.take();
    }
  }

  bool delete_row(const std::string& id) const {
    return Statement(database, "DELETE FROM jobs WHERE id = ?").bind(id).run() > 0;
  }
  /// What stays because it cannot be removed is met again at the next start.
  void delete_files(const std::string& id) {
    delete_file(Part::results, places.result(id));
    delete_file(Part::requests, places.request(id));
  }
  void delete_file(Part part, const fs::path& file) {
    const auto bytes = bytes_of(file);
    std::error_code ignored;
    if (fs::remove(file, ignored)) space.add(part, -bytes);
  }

  /// Writes a file whose space is taken first.
  void write(Part part, const fs::path& file, std::initializer_list<std::string_view> pieces) {
    std::int64_t bytes = 0;
    for (const auto piece : pieces) bytes += static_cast<std::int64_t>(piece.size());
    take(part, bytes);
    TakenSpace taken(space, part, bytes);
    write_stored_file(file, pieces);
    taken.keep();
  }

  /// Under the mutex: tells the database when meshes were used last.
  void write_uses() {
    if (uses.empty()) return;
    const QuickCommits quick(database);
    Transaction transaction(database);
    for (const auto& [id, when] : uses)
      Statement(database, "UPDATE meshes SET used = ? WHERE id = ?").bind(when).bind(id).run();
    transaction.commit();
    uses.clear();
  }

  const DataFolder folder;
  const Places& places;
  bool database_is_new = false;
  mutable std::mutex mutex;
  const std::unique_ptr<Database> connection;
  Database& database;
  OwnerTable owners;
  Space space;
  const std::function<std::int64_t(const std::string& owner)> quota_of_owner;
  Reserve reserve;
  mutable std::mutex uses_mutex;
  std::map<std::string, std::int64_t> uses;  ///< of meshes, since the database was told last
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
    implementation_->write_uses();
  } catch (const Error&) {
    // Those meshes count as unused for as long as they did.
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
      write_stored_file(self.places.mesh(record.id), {ply});
      self.space.count();  // nobody knows how large it was when it was counted
    }
    const std::lock_guard lock(self.mutex);
    if (auto known = self.find_mesh(record.id))
      return {std::move(*known), self.own_mesh(record.id, owner, limit, bytes)};
    // Its last owner has removed it meanwhile: it is a new one.
  }
  record.created = now_milliseconds();
  record.description = describe(record.id, record.created);
  {
    const std::lock_guard lock(self.mutex);  // before others' results go
    self.make_room_of_owner(owner, limit, Part::meshes, bytes);
  }
  self.take(Part::meshes, bytes);
  TakenSpace taken(self.space, Part::meshes, bytes);
  // Taking turns from here on, so that the deletion of the same mesh cannot fall between file and row.
  const std::lock_guard lock(self.mutex);
  if (auto known = self.find_mesh(record.id)) return {std::move(*known), self.own_mesh(record.id, owner, limit, bytes)};
  self.make_room_of_owner(owner, limit, Part::meshes, bytes);
  write_stored_file(self.places.mesh(record.id), {ply});
  try {
    Transaction transaction(self.database);
    insert_mesh(self.database, record, bytes);
    if (!owner.empty()) self.owners.add(OwnerTable::Kind::mesh, record.id, owner);
    transaction.commit();
  } catch (...) {
    std::error_code ignored;
    fs::remove(self.places.mesh(record.id), ignored);
    throw;
  }
  taken.keep();
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
  auto bytes = read_file(implementation_->places.mesh(id), cancellation);
  if (sha256(bytes, cancellation) != id)
    throw Error("store.corrupted", "The stored file " + id + ".ply has changed since it was written.");
  return bytes;
}

OpenContent LocalStore::open_mesh_content(const std::string& id, const CancellationToken& cancellation) const {
  if (!mesh(id)) throw Error("mesh.not_found", "There is no mesh " + id + ".");
  return open_checked(implementation_->places.mesh(id), {}, id, cancellation);
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
  self.delete_file(Part::meshes, self.places.mesh(id));  // a file without a row is a mesh again at the next start
  self.reserve.take();
  return true;
}

void LocalStore::use_mesh(const std::string& id) const {
  const std::lock_guard lock(implementation_->uses_mutex);
  implementation_->uses[id] = now_milliseconds();
}

std::vector<std::string> LocalStore::remove_unused_meshes(std::int64_t before) {
  auto& self = *implementation_;
  std::vector<std::string> ids;
  const std::scoped_lock lock(self.mutex, self.uses_mutex);
  self.write_uses();
  {
    Statement rows(self.database,
                   "SELECT id FROM meshes WHERE max(created, used) < ? AND id NOT IN "
                   "(SELECT mesh FROM jobs WHERE finished = 0)");
    for (rows.bind(before); rows.step();) ids.push_back(rows.text(0));
  }
  for (const auto& id : ids) {
    self.with_reserve([&] { Statement(self.database, "DELETE FROM meshes WHERE id = ?").bind(id).run(); });
    self.delete_file(Part::meshes, self.places.mesh(id));
  }
  self.reserve.take();
  return ids;
}

std::string LocalStore::keep_request(const JobRecord& job, const JobRequest& request, std::string_view body) {
  auto& self = *implementation_;
  auto content = request_file(job, request).header(sha256(body));
  if (const auto limit = self.limit_of(job.owner); limit > 0) {
    const std::lock_guard lock(self.mutex);
    self.make_room_of_owner(job.owner, limit, Part::requests, static_cast<std::int64_t>(content.size() + body.size()));
  }
  if (body.size() > largest_request_in_database) {
    self.write(Part::requests, self.places.request(job.id), {content, body});
    return {};
  }
  content += body;
  const auto bytes = static_cast<std::int64_t>(content.size());
  self.take(Part::requests, bytes);
  TakenSpace taken(self.space, Part::requests, bytes);
  write_spare_file(self.places.request(job.id), {content});
  taken.keep();
  return content;
}

void LocalStore::drop_request(const std::string& id) {
  implementation_->delete_file(Part::requests, implementation_->places.request(id));
}

bool LocalStore::has_request(const std::string& id) const {
  {
    const std::lock_guard lock(implementation_->mutex);
    if (implementation_->request_in_database(id)) return true;
  }
  std::error_code ignored;
  return fs::exists(implementation_->places.request(id), ignored);
}

StoredRequest LocalStore::job_request(const std::string& id) const {
  std::unique_lock lock(implementation_->mutex);
  auto in_database = implementation_->request_in_database(id);
  lock.unlock();
  auto bytes = in_database ? *std::move(in_database) : read_file(implementation_->places.request(id));
  const auto file = RecordFile::parse(request_kind, bytes, id + ".request");
  bytes.erase(0, file.header_size());
  if (sha256(bytes) != file.body_hash()) throw_changed(id + ".request");
  return {request_of(file), std::move(bytes)};
}

bool LocalStore::add_job(const JobRecord& job, const std::string& request) {
  auto& self = *implementation_;
  auto& database = self.database;
  const auto limit = self.limit_of(job.owner);
  const auto bytes =
      request.empty() ? bytes_of(self.places.request(job.id)) : static_cast<std::int64_t>(request.size());
  const std::lock_guard lock(self.mutex);
  if (!job.idempotency_key.empty() && self.find_job_of_key(job.idempotency_key)) return false;
  self.make_room_of_owner(job.owner, limit, Part::requests, bytes, job.id);
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
  const QuickCommits quick(database);
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
  const auto path = self.places.result(job.id);
  const auto limit = result ? self.limit_of(job.owner) : 0;
  bool known = false;
  try {
    ResultFile file;
    const auto make_room = [&] { self.make_room_of_owner(job.owner, limit, Part::results, file.bytes, job.id); };
    if (result) {
      file.hash = sha256(result->body);
      const auto header = result_file(job, *result).header(file.hash);
      file.bytes = static_cast<std::int64_t>(header.size() + result->body.size());
      if (limit > 0) {
        const std::lock_guard lock(self.mutex);
        make_room();
      }
      self.write(Part::results, path, {header, result->body});
    }
    const std::lock_guard lock(self.mutex);
    make_room();  // others may have ended meanwhile
    known = update_ended_job(self.database, job, result, file);
  } catch (...) {
    // A result without its row takes the space that the reason of the failure needs.
    if (result) self.delete_file(Part::results, path);
    throw;
  }
  if (!known) self.delete_file(Part::results, path);
  drop_request(job.id);
  return known;
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
  std::string names;  // of ours, so that they can be part of the statement
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
          open_checked(implementation_->places.result(id), result_kind, hash, {})};
}

bool LocalStore::remove_job(const std::string& id) {
  auto& self = *implementation_;
  const std::lock_guard lock(self.mutex);
  if (!self.with_reserve([&] { return self.delete_row(id); })) return false;
  self.delete_files(id);
  self.reserve.take();
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

std::size_t LocalStore::remove_expired_jobs(std::int64_t now, std::size_t most) {
  auto& self = *implementation_;
  self.space.count_quarantine();
  const std::lock_guard lock(self.mutex);
  std::vector<std::string> ids;
  {
    Statement rows(self.database,
                   "SELECT id FROM jobs WHERE finished > 0 AND (expires <= ?1 OR sequence NOT IN "
                   "(SELECT sequence FROM jobs WHERE finished > 0 ORDER BY sequence DESC LIMIT ?2))");
    rows.bind(now).bind(static_cast<std::int64_t>(most));
    while (rows.step()) ids.push_back(rows.text(0));
  }
  self.remove_jobs(ids);
  self.reserve.take();
  return ids.size();
}

void LocalStore::take_reserve() {
  const std::lock_guard lock(implementation_->mutex);
  implementation_->reserve.take();
}

Usage LocalStore::usage() const { return implementation_->space.usage(); }

}  // namespace supple::store
