#include "schema.h"

#include <utility>
#include <vector>

#include "file_access.h"
#include "record_file.h"
#include "supple/store/store_error.h"

namespace supple::store {
namespace {

/// Version of the tables. Version 1 had no clients, sessions and attempts of jobs, and no times of use of meshes.
constexpr std::int64_t table_version = 2;

constexpr const char* tables = R"(
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
CREATE TABLE IF NOT EXISTS clock (
  machine_start_id TEXT NOT NULL,
  machine_start INTEGER NOT NULL
);
CREATE TABLE IF NOT EXISTS families (
  sequence INTEGER PRIMARY KEY AUTOINCREMENT,
  id TEXT NOT NULL UNIQUE,
  owner TEXT NOT NULL,
  name TEXT NOT NULL,
  created INTEGER NOT NULL,
  definition TEXT NOT NULL,
  description TEXT NOT NULL,
  hash TEXT NOT NULL,
  bytes INTEGER NOT NULL,
  UNIQUE (owner, name)
);
CREATE TABLE IF NOT EXISTS requests (
  job TEXT PRIMARY KEY,
  content BLOB NOT NULL
);
CREATE TRIGGER IF NOT EXISTS requests_of_ended_jobs AFTER UPDATE OF finished ON jobs WHEN new.finished > 0
BEGIN DELETE FROM requests WHERE job = new.id; END;
CREATE TRIGGER IF NOT EXISTS requests_of_removed_jobs AFTER DELETE ON jobs
BEGIN DELETE FROM requests WHERE job = old.id; END;
)";

/// A column that was added to a table after version 1. "bytes" is the size of the file; -1: not counted yet.
struct Column {
  const char* table;
  const char* name;
  const char* declaration;
};
constexpr Column later_columns[] = {
    {"meshes", "used", "INTEGER NOT NULL DEFAULT 0"},        {"jobs", "client", "TEXT NOT NULL DEFAULT ''"},
    {"jobs", "session", "TEXT NOT NULL DEFAULT ''"},         {"jobs", "attempts", "INTEGER NOT NULL DEFAULT 0"},
    {"meshes", "bytes", "INTEGER NOT NULL DEFAULT -1"},      {"jobs", "bytes", "INTEGER NOT NULL DEFAULT -1"},
    {"jobs", "idempotency_key", "TEXT NOT NULL DEFAULT ''"}, {"jobs", "request_hash", "TEXT NOT NULL DEFAULT ''"},
    {"jobs", "priority", "TEXT NOT NULL DEFAULT 'normal'"},  {"jobs", "families", "TEXT NOT NULL DEFAULT ''"},
};

constexpr const char* indices_of_later_columns =
    "CREATE UNIQUE INDEX IF NOT EXISTS jobs_by_key ON jobs (idempotency_key) WHERE idempotency_key <> ''";

/// The columns of the table "jobs" that make a job.
constexpr const char* job_columns =
    "id, kind, mesh, state, created, started, finished, expires, deadline, error, error_status, client, session, "
    "attempts, idempotency_key, request_hash, priority, families";

bool has_column(const Database& database, const Column& column) {
  Statement rows(database, "SELECT 1 FROM pragma_table_info(?) WHERE name = ?");
  return rows.bind(column.table).bind(column.name).step();
}

}  // namespace

bool has_table(const Database& database, std::string_view name) {
  Statement row(database, "SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = ?");
  return row.bind(name).step();
}

std::string job_columns_to_read() { return std::string(job_columns) + ", " + OwnerTable::owner_of_job(); }

void prepare_tables(Database& database) {
  {
    Statement row(database, "PRAGMA user_version");
    if (row.step() && row.integer(0) > table_version) {
      throw StoreUnavailable("The data folder was written by a later version of the server (tables of version " +
                             std::to_string(row.integer(0)) + "; this one knows " + std::to_string(table_version) +
                             ").");
    }
  }
  database.execute(tables);
  // The version does not tell which columns exist: a server of version 1 may have used the folder in between.
  for (const auto& column : later_columns) {
    if (has_column(database, column)) continue;
    database.execute(
        ("ALTER TABLE " + std::string(column.table) + " ADD COLUMN " + column.name + " " + column.declaration).c_str());
  }
  database.execute(indices_of_later_columns);
  database.execute(("PRAGMA user_version = " + std::to_string(table_version)).c_str());
  // A column that is missing is found now, and not by the first request that needs it.
  const Statement clock(database, "SELECT machine_start_id, machine_start FROM clock");
  const Statement meshes(database, "SELECT id, created, description, used, bytes, sequence FROM meshes");
  const Statement families(database, "SELECT " + family_columns() + ", bytes, sequence FROM families");
  const Statement jobs(database, "SELECT " + std::string(job_columns) +
                                     ", bytes, result_type, result_headers, result_hash, sequence FROM jobs");
}

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
  job.client = row.text(11);
  job.session = row.text(12);
  job.attempts = static_cast<int>(row.integer(13));
  job.idempotency_key = row.text(14);
  job.request_hash = row.text(15);
  job.priority = priority_of(row.text(16)).value_or(Priority::normal);
  job.families = row.text(17);
  job.owner = row.text(18);
  return job;
}

void insert_job(const Database& database, const JobRecord& job, std::int64_t request_bytes, OwnerTable& owners) {
  Statement(database, "INSERT INTO jobs (" + std::string(job_columns) +
                          ", bytes) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
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
      .bind(job.client)
      .bind(job.session)
      .bind(static_cast<std::int64_t>(job.attempts))
      .bind(job.idempotency_key)
      .bind(job.request_hash)
      .bind(priority_name(job.priority))
      .bind(job.families)
      .bind(request_bytes)
      .run();
  if (!job.owner.empty()) owners.add(OwnerTable::Kind::job, job.id, job.owner);
}

bool update_ended_job(const Database& database, const JobRecord& job, const Result* result, const ResultFile& file) {
  return Statement(database,
                   "UPDATE jobs SET state = ?, started = ?, finished = ?, expires = ?, error = ?, error_status = ?, "
                   "attempts = ?, bytes = ?, result_type = ?, result_headers = ?, result_hash = ? WHERE id = ?")
             .bind(state_name(job.state))
             .bind(job.started)
             .bind(job.finished)
             .bind(job.expires)
             .bind(job.error)
             .bind(static_cast<std::int64_t>(job.error_status))
             .bind(static_cast<std::int64_t>(job.attempts))
             .bind(file.bytes)
             .bind(result ? result->content_type : "")
             .bind(result ? join_headers(*result) : "")
             .bind(file.hash)
             .bind(job.id)
             .run() > 0;
}

void insert_mesh(const Database& database, const MeshRecord& mesh, std::int64_t bytes) {
  Statement(database, "INSERT INTO meshes (id, created, description, bytes) VALUES (?, ?, ?, ?)")
      .bind(mesh.id)
      .bind(mesh.created)
      .bind(mesh.description)
      .bind(bytes)
      .run();
}

FamilyRecord read_family(const Statement& row) {
  return {row.text(0), row.text(1), row.text(2), row.integer(3), row.text(4), row.text(5)};
}

void insert_family(const Database& database, const FamilyRecord& family, const std::string& hash) {
  Statement(database, "INSERT INTO families (" + family_columns() + ", bytes) VALUES (?, ?, ?, ?, ?, ?, ?, ?)")
      .bind(family.id)
      .bind(family.owner)
      .bind(family.name)
      .bind(family.created)
      .bind(family.definition)
      .bind(family.description)
      .bind(hash)
      .bind(bytes_of_family(family))
      .run();
}

void fill_missing_byte_counts(Database& database, const DataPaths& paths) {
  std::vector<std::pair<std::string, std::int64_t>> meshes;
  std::vector<std::pair<std::string, std::int64_t>> jobs;
  for (Statement rows(database, "SELECT id FROM meshes WHERE bytes < 0"); rows.step();)
    meshes.emplace_back(rows.text(0), bytes_of(paths.mesh(rows.text(0))));
  for (Statement rows(database, "SELECT id, finished FROM jobs WHERE bytes < 0"); rows.step();) {
    const auto id = rows.text(0);
    jobs.emplace_back(id, bytes_of(rows.integer(1) > 0 ? paths.result(id) : paths.request(id)));
  }
  if (meshes.empty() && jobs.empty()) return;
  Transaction transaction(database);
  for (const auto& [id, bytes] : meshes)
    Statement(database, "UPDATE meshes SET bytes = ? WHERE id = ?").bind(bytes).bind(id).run();
  for (const auto& [id, bytes] : jobs)
    Statement(database, "UPDATE jobs SET bytes = ? WHERE id = ?").bind(bytes).bind(id).run();
  transaction.commit();
}

}  // namespace supple::store
