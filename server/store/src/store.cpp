#include "supple/store/store.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <set>
#include <system_error>

#include "atomic_file.h"
#include "database.h"
#include "owner_table.h"
#include "supple/base/error.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 5> state_names{"accepted", "running", "successful", "failed", "dismissed"};

constexpr const char* schema = R"(
PRAGMA journal_mode = WAL;
PRAGMA synchronous = FULL;
CREATE TABLE IF NOT EXISTS meshes (
  sequence INTEGER PRIMARY KEY AUTOINCREMENT,
  id TEXT NOT NULL UNIQUE,
  created INTEGER NOT NULL,
  description TEXT NOT NULL
);
CREATE TABLE IF NOT EXISTS jobs (
  sequence INTEGER PRIMARY KEY AUTOINCREMENT,
  id TEXT NOT NULL UNIQUE,
  kind TEXT NOT NULL,
  mesh TEXT NOT NULL,
  state TEXT NOT NULL,
  created INTEGER NOT NULL,
  started INTEGER NOT NULL,
  finished INTEGER NOT NULL,
  expires INTEGER NOT NULL,
  deadline REAL NOT NULL,
  error TEXT NOT NULL,
  error_status INTEGER NOT NULL,
  result_type TEXT NOT NULL DEFAULT '',
  result_headers TEXT NOT NULL DEFAULT '',
  result_hash TEXT NOT NULL DEFAULT ''
);
CREATE INDEX IF NOT EXISTS jobs_by_state ON jobs (state, sequence);
PRAGMA user_version = 1;
)";

constexpr const char* job_columns =
    "id, kind, mesh, state, created, started, finished, expires, deadline, error, error_status";

JobRecord read_job(const Statement& row) {
  JobRecord job;
  job.id = row.text(0);
  job.kind = row.text(1);
  job.mesh = row.text(2);
  job.state = state_of(row.text(3)).value_or(JobState::failed);
  job.created = row.integer(4);
  job.started = row.integer(5);
  job.finished = row.integer(6);
  job.expires = row.integer(7);
  job.deadline = row.real(8);
  job.error = row.text(9);
  job.error_status = static_cast<int>(row.integer(10));
  return job;
}

/// Headers as "name: value" lines.
std::string join_headers(const Result& result) {
  std::string text;
  for (const auto& [name, value] : result.headers) text.append(name).append(": ").append(value).append("\n");
  return text;
}

void split_headers(const std::string& text, Result& result) {
  std::size_t begin = 0;
  while (begin < text.size()) {
    const auto end = text.find('\n', begin);
    const auto colon = text.find(": ", begin);
    result.headers.emplace_back(text.substr(begin, colon - begin), text.substr(colon + 2, end - colon - 2));
    begin = end + 1;
  }
}

/// Whether write_atomically left it: the process ended before the file was complete.
bool is_unfinished(const fs::path& path) { return path.extension() == unfinished_suffix; }

/// Milliseconds since 1970.
std::int64_t modified(const fs::path& path) {
  const auto age = fs::file_time_type::clock::now() - fs::last_write_time(path);
  return now_milliseconds() - std::chrono::duration_cast<std::chrono::milliseconds>(age).count();
}

/// "20260131T235959Z", in UTC.
std::string compact_time() {
  const auto seconds = static_cast<std::time_t>(now_milliseconds() / 1000);
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  std::array<char, 20> text{};
  return {text.data(), std::strftime(text.data(), text.size(), "%Y%m%dT%H%M%SZ", &parts)};
}

}  // namespace

std::string_view state_name(JobState state) { return state_names[static_cast<std::size_t>(state)]; }

std::optional<JobState> state_of(std::string_view name) {
  const auto found = std::find(state_names.begin(), state_names.end(), name);
  if (found == state_names.end()) return std::nullopt;
  return static_cast<JobState>(found - state_names.begin());
}

struct Store::Implementation {
  Implementation(const fs::path& data, const Recovery& means)
      : recovery(means),
        folder(data),
        prepared(prepare_folder()),
        lock(take_lock(data)),
        connection(open_database()),
        database(*connection),
        owners(database) {
    recover_meshes();
    recover_results();
  }
  ~Implementation() { ::close(lock); }

  /// For the server's user alone, also where an earlier version or an administrator made the folder.
  bool prepare_folder() const {
    const bool existed = fs::exists(folder);
    fs::create_directories(folder);
    const auto before = fs::status(folder).permissions();
    if (before != fs::perms::owner_all) {
      std::error_code error;
      fs::permissions(folder, fs::perms::owner_all, error);
      if (error) {
        warn("the data folder may be entered by others and belongs to another user, so this cannot be changed: " +
             error.message());
      } else if (existed) {
        warn("the data folder could be entered by others, and is for the server's user alone now (mode 0700)");
      }
    }
    fs::create_directories(folder / "meshes");
    fs::create_directories(folder / "results");
    return true;
  }

  /// One process at a time: a second one would call this one's running jobs interrupted.
  static int take_lock(const fs::path& data) {
    const int descriptor = ::open((data / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (descriptor < 0) {
      throw Error("store.unavailable", "The data folder " + data.string() +
                                           " is not writable: " + std::generic_category().message(errno) + ".");
    }
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
      ::close(descriptor);
      throw Error("store.unavailable", "The data folder " + data.string() + " is in use by another server.");
    }
    return descriptor;
  }

  static std::unique_ptr<Database> try_database(const fs::path& path) {
    auto opened = std::make_unique<Database>(path);
    opened->check();
    opened->execute(schema);
    // A column that is missing is found now, not by the first request that needs it.
    const Statement meshes(*opened, "SELECT id, created, description FROM meshes");
    const Statement jobs(*opened, "SELECT " + std::string(job_columns) +
                                      ", result_type, result_headers, result_hash, sequence FROM jobs");
    const OwnerTable owners(*opened);
    return opened;
  }

  std::unique_ptr<Database> open_database() const {
    const auto path = folder / "supple.sqlite";
    const auto set_aside = [&] {
      // Its log and its index belong to it: beside a new database they would be taken for that one's.
      for (const char* suffix : {"", "-wal", "-shm"}) {
        auto file = path;
        file += suffix;
        if (fs::exists(file)) quarantine(file);
      }
    };
    if (!fs::exists(path)) set_aside();
    try {
      return try_database(path);
    } catch (const DamagedDatabase& error) {
      warn(std::string(error.what()) + " It is set aside and a new one is made.");
    }
    set_aside();
    return try_database(path);
  }

  void warn(const std::string& text) const {
    if (recovery.warn) recovery.warn(text);
  }

  /// Moves a file into the folder of what is not understood, under a name that says when. Throws fs::filesystem_error.
  void quarantine(const fs::path& file) const {
    const auto target_folder = folder / "quarantine";
    fs::create_directories(target_folder);
    const auto name = compact_time() + "-" + file.filename().string();
    auto target = target_folder / name;
    for (int i = 1; fs::exists(target); ++i) target = target_folder / (name + "." + std::to_string(i));
    fs::rename(file, target);
    warn("the file " + file.filename().string() + " is moved to quarantine/" + target.filename().string());
  }

  /// For a file that the server can do without: where it cannot be moved, as on a full disk, it stays.
  void try_to_quarantine(const fs::path& file) const {
    try {
      quarantine(file);
    } catch (const fs::filesystem_error& error) {
      warn("the file " + file.filename().string() + " is unknown and cannot be moved: " + error.code().message());
    }
  }

  /// The regular files of a folder that no row knows, without the half-written ones, which are removed.
  std::vector<fs::path> unknown_files(const char* subfolder, const std::string& suffix, const char* known_ids) const {
    std::set<std::string> known;
    for (Statement rows(database, known_ids); rows.step();) known.insert(rows.text(0) + suffix);
    std::vector<fs::path> unknown;
    for (const auto& entry : fs::directory_iterator(folder / subfolder)) {
      if (!entry.is_regular_file() || known.contains(entry.path().filename().string())) continue;
      unknown.push_back(entry.path());
    }
    std::error_code ignored;
    const auto unfinished = std::stable_partition(unknown.begin(), unknown.end(),
                                                  [](const fs::path& path) { return !is_unfinished(path); });
    for (auto path = unfinished; path != unknown.end(); ++path) fs::remove(*path, ignored);
    unknown.erase(unfinished, unknown.end());
    return unknown;
  }

  /// The row of a mesh from its file; nothing where the file is not what its name says.
  std::optional<MeshRecord> describe_file(const fs::path& file, std::int64_t created) const {
    if (file.extension() != ".ply" || !recovery.describe) return std::nullopt;
    MeshRecord record{file.stem().string(), created, {}};
    try {
      const auto ply = read_file(file);
      if (sha256(ply) != record.id) return std::nullopt;
      record.description = recovery.describe(ply, record.id, created);
    } catch (const std::exception& error) {
      warn("the file " + file.filename().string() + " cannot be indexed: " + error.what());
      return std::nullopt;
    }
    return record;
  }

  void recover_meshes() {
    std::vector<std::pair<std::int64_t, fs::path>> files;
    for (auto& file : unknown_files("meshes", ".ply", "SELECT id FROM meshes")) {
      const auto created = modified(file);
      files.emplace_back(created, std::move(file));
    }
    std::sort(files.begin(), files.end());
    for (const auto& [created, file] : files) {
      const auto record = describe_file(file, created);
      if (!record) {
        try_to_quarantine(file);
        continue;
      }
      try {
        insert_mesh(*record);
        warn("the mesh " + record->id + " had no row and is indexed again");
      } catch (const Error& error) {
        warn("the mesh " + record->id + " cannot be indexed before the next start: " + error.what());
      }
    }
  }

  void recover_results() {
    std::set<std::string> unacknowledged;
    for (Statement rows(database, "SELECT id FROM jobs WHERE result_hash = ''"); rows.step();)
      unacknowledged.insert(rows.text(0) + ".result");
    for (const auto& file : unknown_files("results", ".result", "SELECT id FROM jobs WHERE result_hash <> ''")) {
      std::error_code ignored;
      if (unacknowledged.contains(file.filename().string())) {
        fs::remove(file, ignored);
      } else {
        try_to_quarantine(file);
      }
    }
  }

  void insert_mesh(const MeshRecord& record) {
    Statement(database, "INSERT INTO meshes (id, created, description) VALUES (?, ?, ?)")
        .bind(record.id)
        .bind(record.created)
        .bind(record.description)
        .run();
  }

  fs::path mesh_path(const std::string& id) const { return folder / "meshes" / (id + ".ply"); }
  fs::path result_path(const std::string& id) const { return folder / "results" / (id + ".result"); }

  std::optional<MeshRecord> find_mesh(const std::string& id) const {
    Statement row(database, "SELECT created, description FROM meshes WHERE id = ?");
    if (!row.bind(id).step()) return std::nullopt;
    return MeshRecord{id, row.integer(0), row.text(1)};
  }

  bool delete_row(const std::string& id) {
    return Statement(database, "DELETE FROM jobs WHERE id = ?").bind(id).run() > 0;
  }
  void delete_result(const std::string& id) const {
    std::error_code ignored;  // a file without a row goes into quarantine at the next start
    fs::remove(result_path(id), ignored);
  }

  const Recovery recovery;
  const fs::path folder;
  const bool prepared;  ///< the folder is there before the lock in it is taken
  const int lock;
  mutable std::mutex mutex;
  const std::unique_ptr<Database> connection;
  Database& database;
  OwnerTable owners;
};

Store::Store(const fs::path& folder, const Recovery& recovery) {
  try {
    implementation_ = std::make_unique<Implementation>(folder, recovery);
  } catch (const fs::filesystem_error& error) {
    throw Error("store.unavailable",
                "The data folder " + folder.string() + " cannot be used: " + error.code().message() + ".");
  }
}
Store::~Store() = default;

std::pair<MeshRecord, bool> Store::add_mesh(const std::string& ply, const DescribeMesh& describe,
                                            const std::string& owner) {
  while (true) {
    auto added = add_content(ply, describe);
    if (owner.empty()) return added;
    auto& self = *implementation_;
    const std::lock_guard lock(self.mutex);
    if (!self.find_mesh(added.first.id)) continue;  // its last other owner has removed it meanwhile
    added.second = self.owners.add(OwnerTable::Kind::mesh, added.first.id, owner);
    return added;
  }
}

std::pair<MeshRecord, bool> Store::add_content(const std::string& ply, const DescribeMesh& describe) {
  auto& self = *implementation_;
  MeshRecord record;
  record.id = sha256(ply);
  if (auto known = mesh(record.id)) {
    // Uploading again repairs a file that has been damaged.
    try {
      mesh_content(record.id);
    } catch (const Error&) {
      write_atomically(self.mesh_path(record.id), ply);
    }
    return {std::move(*known), false};
  }
  record.created = now_milliseconds();
  record.description = describe(record.id, record.created);
  // Taking turns from here on, so that the deletion of the same mesh cannot fall between file and row.
  const std::lock_guard lock(self.mutex);
  if (auto known = self.find_mesh(record.id)) return {std::move(*known), false};
  write_atomically(self.mesh_path(record.id), ply);
  self.insert_mesh(record);
  return {std::move(record), true};
}

std::optional<MeshRecord> Store::mesh(const std::string& id) const {
  const std::lock_guard lock(implementation_->mutex);
  return implementation_->find_mesh(id);
}

std::vector<MeshRecord> Store::meshes(std::size_t limit, const std::string& after, const std::string& owner) const {
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

std::string Store::mesh_content(const std::string& id) const {
  if (!mesh(id)) throw Error("mesh.not_found", "There is no mesh " + id + ".");
  auto bytes = read_file(implementation_->mesh_path(id));
  if (sha256(bytes) != id)
    throw Error("store.corrupted", "The stored file " + id + ".ply has changed since it was written.");
  return bytes;
}

bool Store::owns_mesh(const std::string& id, const std::string& owner) const {
  const std::lock_guard lock(implementation_->mutex);
  return implementation_->owners.has(OwnerTable::Kind::mesh, id, owner);
}

bool Store::is_last_owner_of_mesh(const std::string& id, const std::string& owner) const {
  const std::lock_guard lock(implementation_->mutex);
  const auto& owners = implementation_->owners;
  return owners.has(OwnerTable::Kind::mesh, id, owner) && owners.count(OwnerTable::Kind::mesh, id) == 1;
}

bool Store::remove_mesh(const std::string& id, const std::string& owner) {
  const std::lock_guard lock(implementation_->mutex);
  if (!owner.empty()) {
    auto& owners = implementation_->owners;
    if (!owners.has(OwnerTable::Kind::mesh, id, owner)) return false;
    if (owners.count(OwnerTable::Kind::mesh, id) > 1) return owners.remove(OwnerTable::Kind::mesh, id, owner);
  }
  if (Statement(implementation_->database, "DELETE FROM meshes WHERE id = ?").bind(id).run() == 0) return false;
  std::error_code ignored;  // a file without a row is a mesh again at the next start
  fs::remove(implementation_->mesh_path(id), ignored);
  return true;
}

void Store::add_job(const JobRecord& job) {
  const std::lock_guard lock(implementation_->mutex);
  Statement(
      implementation_->database,
      "INSERT INTO jobs (id, kind, mesh, state, created, started, finished, expires, deadline, error, error_status) "
      "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
      .bind(job.id)
      .bind(job.kind)
      .bind(job.mesh)
      .bind(state_name(job.state))
      .bind(job.created)
      .bind(job.started)
      .bind(job.finished)
      .bind(job.expires)
      .bind(job.deadline)
      .bind(job.error)
      .bind(static_cast<std::int64_t>(job.error_status))
      .run();
}

void Store::finish_job(const JobRecord& job, const Result* result) {
  auto& self = *implementation_;
  int changed = 0;
  try {
    if (result) write_atomically(self.result_path(job.id), result->body);
    const std::lock_guard lock(self.mutex);
    changed = Statement(self.database,
                        "UPDATE jobs SET state = ?, started = ?, finished = ?, expires = ?, error = ?, "
                        "error_status = ?, result_type = ?, result_headers = ?, result_hash = ? WHERE id = ?")
                  .bind(state_name(job.state))
                  .bind(job.started)
                  .bind(job.finished)
                  .bind(job.expires)
                  .bind(job.error)
                  .bind(static_cast<std::int64_t>(job.error_status))
                  .bind(result ? result->content_type : "")
                  .bind(result ? join_headers(*result) : "")
                  .bind(result ? sha256(result->body) : "")
                  .bind(job.id)
                  .run();
  } catch (...) {
    // A result without its row takes the space that the reason of the failure needs.
    std::error_code ignored;
    if (result) fs::remove(self.result_path(job.id), ignored);
    throw;
  }
  if (changed == 0) {
    std::error_code ignored;
    fs::remove(self.result_path(job.id), ignored);
  }
}

std::optional<JobRecord> Store::job(const std::string& id) const {
  const std::lock_guard lock(implementation_->mutex);
  Statement row(implementation_->database, "SELECT " + std::string(job_columns) + " FROM jobs WHERE id = ?");
  if (!row.bind(id).step()) return std::nullopt;
  return read_job(row);
}

std::vector<JobRecord> Store::jobs(std::optional<JobState> state, std::size_t limit, const std::string& after,
                                   const std::string& owner) const {
  const std::lock_guard lock(implementation_->mutex);
  Statement rows(implementation_->database,
                 "SELECT " + std::string(job_columns) +
                     " FROM jobs WHERE (?1 = '' OR sequence < (SELECT sequence FROM jobs WHERE id = ?1)) "
                     "AND (?2 = '' OR state = ?2) AND " +
                     OwnerTable::condition(OwnerTable::Kind::job, "?4") + " ORDER BY sequence DESC LIMIT ?3");
  rows.bind(after).bind(state ? state_name(*state) : "").bind(static_cast<std::int64_t>(limit)).bind(owner);
  std::vector<JobRecord> records;
  while (rows.step()) records.push_back(read_job(rows));
  return records;
}

void Store::own_job(const std::string& id, const std::string& owner) {
  const std::lock_guard lock(implementation_->mutex);
  implementation_->owners.add(OwnerTable::Kind::job, id, owner);
}

bool Store::owns_job(const std::string& id, const std::string& owner) const {
  const std::lock_guard lock(implementation_->mutex);
  return implementation_->owners.has(OwnerTable::Kind::job, id, owner);
}

Result Store::job_result(const std::string& id) const {
  Result result;
  std::string hash;
  {
    const std::lock_guard lock(implementation_->mutex);
    Statement row(implementation_->database, "SELECT result_type, result_headers, result_hash FROM jobs WHERE id = ?");
    if (!row.bind(id).step()) throw Error("job.not_found", "There is no job " + id + ".");
    result.content_type = row.text(0);
    split_headers(row.text(1), result);
    hash = row.text(2);
  }
  result.body = read_file(implementation_->result_path(id));
  if (sha256(result.body) != hash) {
    throw Error("store.corrupted", "The stored file " + id + ".result has changed since it was written.");
  }
  return result;
}

bool Store::remove_job(const std::string& id) {
  const std::lock_guard lock(implementation_->mutex);
  if (!implementation_->delete_row(id)) return false;
  implementation_->delete_result(id);
  return true;
}

std::vector<JobRecord> Store::unfinished_jobs() const {
  const std::lock_guard lock(implementation_->mutex);
  Statement rows(implementation_->database,
                 "SELECT " + std::string(job_columns) + " FROM jobs WHERE state IN ('accepted', 'running')");
  std::vector<JobRecord> records;
  while (rows.step()) records.push_back(read_job(rows));
  return records;
}

std::size_t Store::remove_expired_jobs(std::int64_t now, std::size_t most) {
  const std::lock_guard lock(implementation_->mutex);
  auto& self = *implementation_;
  std::vector<std::string> ids;
  {
    Statement rows(self.database,
                   "SELECT id FROM jobs WHERE finished > 0 AND (expires <= ?1 OR sequence NOT IN "
                   "(SELECT sequence FROM jobs WHERE finished > 0 ORDER BY sequence DESC LIMIT ?2))");
    rows.bind(now).bind(static_cast<std::int64_t>(most));
    while (rows.step()) ids.push_back(rows.text(0));
  }
  Transaction transaction(self.database);
  for (const auto& id : ids) self.delete_row(id);
  transaction.commit();
  // Only now, for a row that stays because the commit failed must still have its result.
  for (const auto& id : ids) self.delete_result(id);
  return ids.size();
}

}  // namespace supple::store
