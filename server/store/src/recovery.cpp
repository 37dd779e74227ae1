#include "recovery.h"

#include <algorithm>
#include <new>
#include <optional>
#include <set>
#include <system_error>

#include "file_access.h"
#include "owner_table.h"
#include "record_file.h"
#include "schema.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;

void remove_quietly(const fs::path& file) {
  std::error_code ignored;
  fs::remove(file, ignored);
}

std::set<std::string> ids(const Database& database, const char* query) {
  std::set<std::string> found;
  for (Statement rows(database, query); rows.step();) found.insert(rows.text(0));
  return found;
}

/// The regular files of a folder except those of known ids. Half-written files are deleted.
std::vector<fs::path> orphaned_files(const fs::path& folder, const std::string& suffix,
                                     const std::set<std::string>& known) {
  std::vector<fs::path> unknown;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const auto& path = entry.path();
    if (!entry.is_regular_file()) continue;
    if (path.extension() == suffix && known.contains(path.stem().string())) continue;
    unknown.push_back(path);
  }
  const auto unfinished =
      std::stable_partition(unknown.begin(), unknown.end(), [](const fs::path& path) { return !is_unfinished(path); });
  std::for_each(unfinished, unknown.end(), remove_quietly);
  unknown.erase(unfinished, unknown.end());
  return unknown;
}

/// The row of a mesh, made from its file; nothing where the file is not what its name says. Throws std::bad_alloc.
std::optional<MeshRecord> describe_file(const DataFolder& folder, const LocalStore::Recovery& recovery,
                                        const fs::path& file, std::int64_t created) {
  if (file.extension() != ".ply" || !recovery.describe) return std::nullopt;
  MeshRecord record{file.stem().string(), created, {}};
  try {
    const auto ply = read_file(file);
    if (sha256(ply) != record.id) return std::nullopt;
    record.description = recovery.describe(ply, record.id, created);
  } catch (const std::bad_alloc&) {
    throw;  // which says nothing about the file
  } catch (const std::exception& error) {
    folder.warn("the file " + file.filename().string() + " cannot be indexed: " + error.what());
    return std::nullopt;
  }
  return record;
}

void recover_meshes(const DataFolder& folder, Database& database, const LocalStore::Recovery& recovery) {
  std::vector<std::pair<std::int64_t, fs::path>> files;
  for (auto& file : orphaned_files(folder.paths().meshes(), ".ply", ids(database, "SELECT id FROM meshes"))) {
    const auto created = modification_time(file);
    files.emplace_back(created, std::move(file));
  }
  std::sort(files.begin(), files.end());
  for (const auto& [created, file] : files) {
    std::optional<MeshRecord> record;
    try {
      record = describe_file(folder, recovery, file, created);
    } catch (const std::bad_alloc&) {
      folder.warn("the file " + file.filename().string() +
                  " cannot be indexed before the next start: there is not enough memory");
      continue;
    }
    if (!record) {
      folder.try_to_quarantine(file);
      continue;
    }
    try {
      insert_mesh(database, *record, bytes_of(file));
      folder.warn("the mesh " + record->id + " had no row and is indexed again");
    } catch (const Error& error) {
      folder.warn("the mesh " + record->id + " cannot be indexed before the next start: " + error.what());
    }
  }
}

/// A job that was found in a file, from which its row can be made.
struct FoundJob {
  JobRecord job;
  std::optional<Result> result;  ///< the result without its body
  std::string hash;
  fs::path file;
};

/// A job from its file of this kind; nothing where the file is damaged or is not what its name says.
std::optional<FoundJob> read_job_file(const DataFolder& folder, const fs::path& file, std::string_view kind) {
  try {
    const auto bytes = read_file(file);
    const auto record = RecordFile::parse(kind, bytes, file.filename().string());
    FoundJob found{job_of(record), std::nullopt, std::string(record.body_hash()), file};
    if (found.job.id != file.stem().string()) return std::nullopt;
    if (sha256(std::string_view(bytes).substr(record.header_size())) != found.hash) return std::nullopt;
    if (kind == result_kind) found.result = result_of(record);
    return found;
  } catch (const Error& error) {
    folder.warn("the file " + file.filename().string() + " cannot be indexed: " + error.what());
    return std::nullopt;
  }
}

void insert_found_job(const DataFolder& folder, Database& database, OwnerTable& owners, const FoundJob& found) {
  try {
    Transaction transaction(database);
    const auto bytes = bytes_of(found.file);
    insert_job(database, found.job, bytes, owners);
    if (found.result) update_ended_job(database, found.job, &*found.result, {found.hash, bytes});
    transaction.commit();
    folder.warn("the " + std::string(found.result ? "result" : "request") + " of job " + found.job.id +
                " had no row and is indexed again");
  } catch (const Error& error) {
    folder.warn("the job " + found.job.id + " cannot be indexed before the next start: " + error.what());
  }
}

/// Finds results whose jobs get a row again. If a job has a row without a result, the result was never acknowledged and
/// is deleted: the job runs again, or clients were told that it failed.
void find_results(const DataFolder& folder, const Database& database, std::vector<FoundJob>& found) {
  const auto unacknowledged = ids(database, "SELECT id FROM jobs WHERE result_hash = ''");
  const auto known = ids(database, "SELECT id FROM jobs WHERE result_hash <> ''");
  for (const auto& file : orphaned_files(folder.paths().results(), ".result", known)) {
    if (file.extension() == ".result" && unacknowledged.contains(file.stem().string())) {
      remove_quietly(file);
    } else if (auto job = read_job_file(folder, file, result_kind)) {
      found.push_back(std::move(*job));
    } else {
      folder.try_to_quarantine(file);
    }
  }
}

/// Finds requests of jobs that get a row again: only where the database is new, and the job has no result. Other
/// requests without an unfinished job are deleted: they were never acknowledged, or their job has ended.
void find_requests(const DataFolder& folder, const Database& database, bool is_new, std::vector<FoundJob>& found) {
  std::set<std::string> ended;
  for (const auto& job : found) ended.insert(job.job.id);
  const auto waiting = ids(database, "SELECT id FROM jobs WHERE finished = 0");
  for (const auto& file : orphaned_files(folder.paths().requests(), ".request", waiting)) {
    const auto id = file.stem().string();
    const bool is_request = file.extension() == ".request";
    if (is_request && (!is_new || ended.contains(id))) {
      remove_quietly(file);
    } else if (auto job = is_request ? read_job_file(folder, file, request_kind) : std::nullopt) {
      found.push_back(std::move(*job));
    } else {
      folder.try_to_quarantine(file);
    }
  }
}

/// Writes the files of small requests that have none: those of an earlier version, of a restored backup, and of a
/// machine that stopped.
void write_missing_request_copies(const DataFolder& folder, const Database& database) {
  try {
    for (Statement rows(database, "SELECT job, content FROM requests"); rows.step();) {
      const auto path = folder.paths().request(rows.text(0));
      const auto content = rows.text(1);
      if (bytes_of(path) != static_cast<std::int64_t>(content.size())) write_unsynced_file(path, {content});
    }
  } catch (const Error& error) {
    folder.warn(std::string("the requests of waiting jobs are in the database alone: ") + error.what());
  }
}

std::unique_ptr<Database> open_prepared_database(const fs::path& path) {
  auto opened = std::make_unique<Database>(path);
  opened->check();
  prepare_tables(*opened);
  const OwnerTable owners(*opened);
  return opened;
}

}  // namespace

std::unique_ptr<Database> open_database(const DataFolder& folder, bool& is_new) {
  const auto path = folder.paths().database();
  const auto quarantine_database = [&] {
    // The log and the index of a database must go with it. SQLite would take them for those of the new one.
    for (const char* suffix : {"", "-wal", "-shm"}) {
      auto file = path;
      file += suffix;
      if (fs::exists(file)) folder.quarantine(file);
    }
  };
  is_new = !fs::exists(path);
  if (is_new) quarantine_database();
  try {
    return open_prepared_database(path);
  } catch (const DamagedDatabase& error) {
    folder.warn(std::string(error.what()) + " It is set aside and a new one is made.");
  }
  quarantine_database();
  is_new = true;
  return open_prepared_database(path);
}

void recover_files(const DataFolder& folder, Database& database, const LocalStore::Recovery& recovery, bool is_new) {
  recover_meshes(folder, database, recovery);
  std::vector<FoundJob> jobs;
  find_results(folder, database, jobs);
  find_requests(folder, database, is_new, jobs);
  std::sort(jobs.begin(), jobs.end(), [](const FoundJob& a, const FoundJob& b) {
    return std::pair(a.job.created, a.job.id) < std::pair(b.job.created, b.job.id);
  });
  OwnerTable owners(database);
  for (const auto& job : jobs) insert_found_job(folder, database, owners, job);
  write_missing_request_copies(folder, database);
}

}  // namespace supple::store
