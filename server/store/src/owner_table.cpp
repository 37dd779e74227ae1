#include "owner_table.h"

namespace supple::store {
namespace {

constexpr const char* schema = R"(
CREATE TABLE IF NOT EXISTS owners (
  kind TEXT NOT NULL,
  id TEXT NOT NULL,
  owner TEXT NOT NULL,
  PRIMARY KEY (kind, id, owner)
) WITHOUT ROWID;
CREATE INDEX IF NOT EXISTS owned ON owners (owner, kind, id);
CREATE TRIGGER IF NOT EXISTS owners_of_meshes AFTER DELETE ON meshes
BEGIN DELETE FROM owners WHERE kind = 'mesh' AND id = old.id; END;
CREATE TRIGGER IF NOT EXISTS owners_of_jobs AFTER DELETE ON jobs
BEGIN DELETE FROM owners WHERE kind = 'job' AND id = old.id; END;
)";

std::string_view name(OwnerTable::Kind kind) { return kind == OwnerTable::Kind::mesh ? "mesh" : "job"; }

}  // namespace

OwnerTable::OwnerTable(Database& database) : database_(database) {
  database_.execute(schema);
  const Statement columns(database_, "SELECT kind, id, owner FROM owners");  // fails now where a column is missing
}

bool OwnerTable::add(Kind kind, const std::string& id, const std::string& owner) {
  Statement insert(database_, "INSERT OR IGNORE INTO owners (kind, id, owner) VALUES (?, ?, ?)");
  return insert.bind(name(kind)).bind(id).bind(owner).run() > 0;
}

bool OwnerTable::has(Kind kind, const std::string& id, const std::string& owner) const {
  Statement row(database_, "SELECT 1 FROM owners WHERE kind = ? AND id = ? AND owner = ?");
  return row.bind(name(kind)).bind(id).bind(owner).step();
}

bool OwnerTable::remove(Kind kind, const std::string& id, const std::string& owner) {
  Statement row(database_, "DELETE FROM owners WHERE kind = ? AND id = ? AND owner = ?");
  return row.bind(name(kind)).bind(id).bind(owner).run() > 0;
}

std::int64_t OwnerTable::count(Kind kind, const std::string& id) const {
  Statement row(database_, "SELECT COUNT(*) FROM owners WHERE kind = ? AND id = ?");
  row.bind(name(kind)).bind(id).step();
  return row.integer(0);
}

OwnerUsage OwnerTable::owner_usage(const std::string& owner, const std::string& without_job) const {
  OwnerUsage owner_usage;
  Statement meshes(database_,
                   "SELECT COALESCE(SUM(max(bytes, 0)), 0) FROM owners JOIN meshes ON meshes.id = owners.id "
                   "WHERE owners.owner = ? AND owners.kind = 'mesh'");
  if (meshes.bind(owner).step()) owner_usage.meshes = meshes.integer(0);
  Statement families(database_, "SELECT COALESCE(SUM(bytes), 0) FROM families WHERE owner = ?");
  if (families.bind(owner).step()) owner_usage.families = families.integer(0);
  Statement jobs(database_,
                 "SELECT COALESCE(SUM(CASE WHEN finished > 0 THEN max(bytes, 0) END), 0), "
                 "COALESCE(SUM(CASE WHEN finished = 0 THEN max(bytes, 0) END), 0) "
                 "FROM owners JOIN jobs ON jobs.id = owners.id "
                 "WHERE owners.owner = ? AND owners.kind = 'job' AND owners.id <> ?");
  if (jobs.bind(owner).bind(without_job).step()) {
    owner_usage.results = jobs.integer(0);
    owner_usage.requests = jobs.integer(1);
  }
  return owner_usage;
}

std::string OwnerTable::owner_of_job() {
  return "COALESCE((SELECT owner FROM owners WHERE owners.kind = 'job' AND owners.id = jobs.id), '')";
}

std::string OwnerTable::condition(Kind kind, std::string_view parameter) {
  const std::string table = kind == Kind::mesh ? "meshes" : "jobs";
  const std::string value(parameter);
  return "(" + value + " = '' OR EXISTS (SELECT 1 FROM owners WHERE owners.kind = '" + std::string(name(kind)) +
         "' AND owners.id = " + table + ".id AND owners.owner = " + value + "))";
}

}  // namespace supple::store
