#include "shared_schema.h"

#include <filesystem>

#include "file_access.h"
#include "supple/store/store.h"
#include "supple/store/store_error.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;

constexpr int version_of_shared_tables = 1;

/// SQL statements of a lock, with which those who make or alter the tables, or lock others out, do so one after the
/// other. It comes before the lock of any table that others wait for. Those who only want the tables to stay as they
/// are share it.
constexpr const char* table_lock = "SELECT pg_advisory_xact_lock(hashtextextended('supple tables', 0))";
constexpr const char* shared_table_lock = "SELECT pg_advisory_xact_lock_shared(hashtextextended('supple tables', 0))";

/// Columns that were added to tables of version 1. A server that does not know them writes rows with their defaults.
constexpr const char* later_shared_columns =
    "ALTER TABLE jobs ADD COLUMN IF NOT EXISTS priority text NOT NULL DEFAULT 'normal', "
    "ADD COLUMN IF NOT EXISTS families text NOT NULL DEFAULT ''";

/// In "jobs", `holder` is the server that has the lease of the job, empty where none has. `hold` is the fencing token.
constexpr const char* shared_tables = R"(
CREATE TABLE IF NOT EXISTS store (
  version integer NOT NULL,
  id text NOT NULL
);
CREATE TABLE IF NOT EXISTS servers (
  id text PRIMARY KEY,
  until timestamptz NOT NULL
);
CREATE TABLE IF NOT EXISTS meshes (
  sequence bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  id text NOT NULL UNIQUE,
  created bigint NOT NULL,
  used bigint NOT NULL,
  bytes bigint NOT NULL,
  description text NOT NULL
);
CREATE TABLE IF NOT EXISTS mesh_owners (
  mesh text NOT NULL REFERENCES meshes (id) ON DELETE CASCADE,
  owner text NOT NULL,
  PRIMARY KEY (mesh, owner)
);
CREATE INDEX IF NOT EXISTS owned_meshes ON mesh_owners (owner);
CREATE TABLE IF NOT EXISTS families (
  sequence bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  id text NOT NULL UNIQUE,
  owner text NOT NULL,
  name text NOT NULL,
  created bigint NOT NULL,
  definition text NOT NULL,
  description text NOT NULL,
  hash text NOT NULL,
  bytes bigint NOT NULL,
  UNIQUE (owner, name)
);
CREATE TABLE IF NOT EXISTS jobs (
  sequence bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  id text NOT NULL UNIQUE,
  kind text NOT NULL,
  mesh text NOT NULL,
  state text NOT NULL,
  created bigint NOT NULL,
  started bigint NOT NULL,
  finished bigint NOT NULL,
  expires bigint NOT NULL,
  deadline double precision NOT NULL,
  error text NOT NULL,
  error_status integer NOT NULL,
  client text NOT NULL,
  session text NOT NULL,
  owner text NOT NULL,
  attempts integer NOT NULL,
  idempotency_key text NOT NULL,
  request_hash text NOT NULL,
  request bytea,
  bytes bigint NOT NULL,
  result_type text NOT NULL DEFAULT '',
  result_headers text NOT NULL DEFAULT '',
  result_hash text NOT NULL DEFAULT '',
  holder text NOT NULL,
  hold bigint NOT NULL,
  progress double precision NOT NULL DEFAULT 0,
  stage text NOT NULL DEFAULT '',
  partial text NOT NULL DEFAULT '',
  revision bigint NOT NULL DEFAULT 1,
  priority text NOT NULL DEFAULT 'normal',
  families text NOT NULL DEFAULT ''
);
CREATE INDEX IF NOT EXISTS unfinished_jobs ON jobs (sequence) WHERE finished = 0;
CREATE INDEX IF NOT EXISTS held_jobs ON jobs (holder) WHERE finished = 0;
CREATE INDEX IF NOT EXISTS owned_jobs ON jobs (owner) WHERE owner <> '';
CREATE INDEX IF NOT EXISTS jobs_of_meshes ON jobs (mesh) WHERE finished = 0;
CREATE UNIQUE INDEX IF NOT EXISTS jobs_by_key ON jobs (idempotency_key) WHERE idempotency_key <> '';
)";

/// The id of the database that a folder belongs to; empty where it belongs to none.
std::string database_id_of_folder(const DataPaths& paths) {
  if (!fs::exists(paths.shared_marker())) return {};
  auto id = read_file(paths.shared_marker());
  if (!id.empty() && id.back() == '\n') id.pop_back();
  return id;
}

void require_no_own_database(const DataPaths& paths) {
  if (!fs::exists(paths.database())) return;
  throw StoreUnavailable("The data folder " + paths.folder.string() +
                         " belongs to a server with a database of its own (supple.sqlite).");
}

[[noreturn]] void throw_not_its_folder(const DataPaths& paths) {
  throw StoreUnavailable("The data folder " + paths.folder.string() + " is not the one that this database belongs to.");
}

/// Whether all tables and columns are there.
bool is_complete(pqxx::work& transaction) {
  return transaction
      .exec1(
          "SELECT to_regclass('store') IS NOT NULL AND to_regclass('families') IS NOT NULL AND "
          "(SELECT count(*) FROM pg_attribute WHERE attrelid = to_regclass('jobs') AND attname IN ('priority', "
          "'families')) = 2")[0]
      .as<bool>();
}

/// Adds tables and columns that are missing. Altering a table waits for all others who use it, so that it is done only
/// where something is missing. The caller has the `table_lock`.
void add_what_is_missing(pqxx::work& transaction) {
  if (is_complete(transaction)) return;
  transaction.exec0(shared_tables);
  if (!is_complete(transaction)) transaction.exec0(later_shared_columns);
}

constexpr const char* version_and_id = "SELECT version, id FROM store";

void require_version_and_folder(const pqxx::row& row, const DataPaths& paths) {
  if (const auto version = row[0].as<int>(); version > version_of_shared_tables) {
    throw StoreUnavailable("The database was written by a later version of the server (tables of version " +
                           std::to_string(version) + "; this one knows " + std::to_string(version_of_shared_tables) +
                           ").");
  }
  if (database_id_of_folder(paths) != row[1].c_str()) throw_not_its_folder(paths);
}

}  // namespace

void prepare_shared_tables(Postgres& database, const DataFolder& folder) {
  const auto& paths = folder.paths();
  require_no_own_database(paths);
  database.transaction([&](pqxx::work& transaction) {
    if (!is_complete(transaction)) {
      transaction.exec(table_lock);
      add_what_is_missing(transaction);
    }
    if (const auto rows = transaction.exec(version_and_id); !rows.empty()) {
      require_version_and_folder(rows[0], paths);
      return true;
    }
    if (!database_id_of_folder(paths).empty()) throw_not_its_folder(paths);
    const auto id = random_id();
    transaction.exec_params("INSERT INTO store (version, id) VALUES ($1, $2)", version_of_shared_tables, id);
    write_stored_file(paths.shared_marker(), {id, "\n"});
    return true;
  });
}

void require_shared_tables(pqxx::work& transaction, const DataPaths& paths) {
  require_no_own_database(paths);
  const auto throw_no_store = [] { throw StoreUnavailable("There is no store in the database."); };
  if (transaction.exec1("SELECT to_regclass('store') IS NULL")[0].as<bool>()) throw_no_store();
  const auto rows = transaction.exec(version_and_id);
  if (rows.empty()) throw_no_store();
  require_version_and_folder(rows[0], paths);
  if (is_complete(transaction)) return;
  transaction.exec(table_lock);
  add_what_is_missing(transaction);  // unless somebody else has done so meanwhile
}

void lock_out_servers(pqxx::work& transaction) {
  const auto require_none = [&] {
    const auto servers =
        transaction.exec1("SELECT count(*) FROM servers WHERE until > clock_timestamp()")[0].as<std::int64_t>();
    if (servers == 0) return;
    throw StoreUnavailable("The database is in use by " + std::to_string(servers) +
                           (servers == 1 ? " server" : " servers") +
                           "; one that was killed is in it until its lease ends.");
  };
  require_none();  // fails before the locks, which a busy server would delay
  transaction.exec(table_lock);
  transaction.exec0("LOCK TABLE servers, meshes, mesh_owners, families, jobs IN EXCLUSIVE MODE");
  require_none();
}

void lock_out_changes(pqxx::work& transaction) {
  transaction.exec(shared_table_lock);
  transaction.exec0("LOCK TABLE meshes, mesh_owners, families, jobs IN SHARE MODE");
}

std::string shared_job_columns() {
  return "jobs.id, kind, mesh, state, created, started, finished, expires, deadline, error, error_status, client, "
         "session, owner, attempts, idempotency_key, request_hash, priority, families, hold";
}

JobRecord read_shared_job(const pqxx::row& row) {
  JobRecord job;
  int column = 0;
  const auto text = [&] { return std::string(row[column++].c_str()); };
  const auto integer = [&] { return row[column++].as<std::int64_t>(); };
  job.id = text();
  job.kind = text();
  job.mesh = text();
  job.state = state_of(text()).value_or(JobState::failed);
  job.created = integer();
  job.started = integer();
  job.finished = integer();
  job.expires = integer();
  job.deadline = row[column++].as<double>();
  job.error = text();
  job.error_status = static_cast<int>(integer());
  job.client = text();
  job.session = text();
  job.owner = text();
  job.attempts = static_cast<int>(integer());
  job.idempotency_key = text();
  job.request_hash = text();
  job.priority = priority_of(text()).value_or(Priority::normal);
  job.families = text();
  job.fencing_token = integer();
  return job;
}

bool insert_shared_job(pqxx::work& transaction, const JobRecord& job, std::int64_t bytes, const std::string& holder,
                       const std::string& request) {
  const auto rows = transaction.exec_params(
      "INSERT INTO jobs (id, kind, mesh, state, created, started, finished, expires, deadline, error, error_status, "
      "client, session, owner, attempts, idempotency_key, request_hash, bytes, holder, hold, priority, families) "
      "VALUES "
      "($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15, $16, $17, $18, $19, $20, $21, $22) "
      "ON CONFLICT DO NOTHING",
      job.id, job.kind, job.mesh, std::string(state_name(job.state)), job.created, job.started, job.finished,
      job.expires, job.deadline, job.error, job.error_status, job.client, job.session, job.owner, job.attempts,
      job.idempotency_key, job.request_hash, bytes, holder, job.fencing_token, std::string(priority_name(job.priority)),
      job.families);
  if (rows.affected_rows() == 0) return false;
  if (!request.empty()) {
    transaction.exec_params("UPDATE jobs SET request = $2 WHERE id = $1", job.id,
                            pqxx::binarystring(request.data(), request.size()));
  }
  return true;
}

FamilyRecord read_shared_family(const pqxx::row& row) {
  return {row[0].c_str(), row[1].c_str(), row[2].c_str(), row[3].as<std::int64_t>(), row[4].c_str(), row[5].c_str()};
}

bool insert_shared_family(pqxx::work& transaction, const FamilyRecord& family, const std::string& hash) {
  return transaction
             .exec_params("INSERT INTO families (" + family_columns() +
                              ", bytes) VALUES ($1, $2, $3, $4, $5, $6, $7, $8) ON CONFLICT (owner, name) DO NOTHING",
                          family.id, family.owner, family.name, family.created, family.definition, family.description,
                          hash, bytes_of_family(family))
             .affected_rows() > 0;
}

std::string shared_result_stem(const std::string& id, std::int64_t fencing_token) {
  return id + "." + std::to_string(fencing_token);
}

}  // namespace supple::store
