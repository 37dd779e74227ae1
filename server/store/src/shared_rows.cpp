#include "shared_rows.h"

#include "file_access.h"
#include "owner_table.h"
#include "record_file.h"
#include "schema.h"
#include "shared_schema.h"

namespace supple::store {
namespace {

using Kind = StoredFile::Kind;

/// Rows that are in memory at a time. Those with requests have up to 256 KiB each.
constexpr std::size_t rows_with_requests = 200;
constexpr std::size_t rows_without_requests = 20'000;

/// Calls `call` with the named columns of each row of a table, in the order of the rows.
template <class Row>
void for_each_row(pqxx::work& transaction, const std::string& columns, const std::string& table,
                  const std::string& condition, std::size_t rows_at_a_time, const Row& call) {
  const auto query = "SELECT " + columns + ", sequence FROM " + table + " WHERE sequence > $1 AND " + condition +
                     " ORDER BY sequence LIMIT " + std::to_string(rows_at_a_time);
  for (std::int64_t after = -1;;) {
    const auto rows = transaction.exec_params(query, after);
    for (const auto& row : rows) {
      call(row);
      after = row[row.size() - 1].template as<std::int64_t>();
    }
    if (rows.size() < rows_at_a_time) return;
  }
}

std::string text(const pqxx::field& field) { return field.c_str(); }
std::int64_t integer(const pqxx::field& field) { return field.as<std::int64_t>(); }
std::string bytes(const pqxx::field& field) { return pqxx::binarystring(field).str(); }

/// The columns of a row of "jobs" that follow those that `read_shared_job` reads.
constexpr const char* columns_of_end = ", bytes, result_type, result_headers, result_hash, request";

constexpr const char* contradiction =
    "(state NOT IN ('accepted', 'running', 'successful', 'failed', 'dismissed') OR "
    "(state IN ('accepted', 'running')) <> (finished = 0) OR (state = 'successful') <> (result_hash <> '') OR "
    "(finished > 0 AND request IS NOT NULL))";

}  // namespace

std::vector<StoredFile> shared_files(pqxx::work& transaction) {
  std::vector<StoredFile> files;
  for_each_row(transaction, "id, bytes", "jobs", "finished = 0 AND request IS NULL", rows_without_requests,
               [&](const pqxx::row& row) {
                 files.push_back({Kind::request, text(row[0]), {}, text(row[0]), integer(row[1])});
               });
  for_each_row(transaction, "id, bytes", "meshes", "true", rows_without_requests, [&](const pqxx::row& row) {
    files.push_back({Kind::mesh, text(row[0]), text(row[0]), text(row[0]), integer(row[1])});
  });
  for_each_row(transaction, "id, hold, result_hash, bytes", "jobs", "result_hash <> ''", rows_without_requests,
               [&](const pqxx::row& row) {
                 files.push_back({Kind::result, text(row[0]), text(row[2]),
                                  shared_result_stem(text(row[0]), integer(row[1])), integer(row[3])});
               });
  return files;
}

bool is_named_by_shared_rows(pqxx::work& transaction, const StoredFile& file) {
  const auto is_there = [&](const std::string& condition, const std::string& id) {
    return !transaction.exec_params("SELECT 1 FROM " + condition + " FOR KEY SHARE", id).empty();
  };
  if (file.kind == Kind::mesh) return is_there("meshes WHERE id = $1", file.stem);
  if (file.kind == Kind::request) return is_there("jobs WHERE id = $1 AND finished = 0", file.stem);
  // A server that was lost between writing the file and the row leaves a result with an earlier fencing token. It is
  // deleted at the end of the job.
  const auto id = file.stem.substr(0, file.stem.rfind('.'));
  const auto rows =
      transaction.exec_params("SELECT hold, finished = 0, result_hash <> '' FROM jobs WHERE id = $1 FOR KEY SHARE", id);
  if (rows.empty()) return false;
  const auto fencing_token = integer(rows[0][0]);
  if (rows[0][2].as<bool>()) return file.stem == shared_result_stem(id, fencing_token);
  for (std::int64_t earlier = 0; rows[0][1].as<bool>() && earlier <= fencing_token; ++earlier)
    if (file.stem == shared_result_stem(id, earlier)) return true;
  return false;
}

std::vector<FaultyRow> faulty_rows(pqxx::work& transaction, CheckReport& check) {
  std::vector<FaultyRow> faulty;
  for_each_row(transaction, "id, state, finished > 0, result_hash <> ''", "jobs", contradiction, rows_without_requests,
               [&](const pqxx::row& row) {
                 faulty.push_back({text(row[0]),
                                   "The row of the job " + text(row[0]) + " contradicts itself: its state is \"" +
                                       text(row[1]) + "\", and it has " + (row[2].as<bool>() ? "" : "not ") +
                                       "ended and " + (row[3].as<bool>() ? "a" : "no") + " result.",
                                   {}});
               });
  for_each_row(transaction, "id, request", "jobs", "finished = 0 AND request IS NOT NULL", rows_with_requests,
               [&](const pqxx::row& row) {
                 ++check.requests;
                 auto request = bytes(row[1]);
                 auto fault = fault_of({Kind::request, text(row[0]), {}}, text(row[0]) + ".request", request);
                 if (!fault.empty()) faulty.push_back({text(row[0]), std::move(fault), std::move(request)});
               });
  return faulty;
}

std::vector<FaultyFamily> faulty_families(pqxx::work& transaction, CheckReport& check) {
  std::vector<FaultyFamily> faulty;
  for_each_row(transaction, family_columns(), "families", "true", rows_with_requests, [&](const pqxx::row& row) {
    ++check.families;
    auto family = read_shared_family(row);
    if (auto fault = fault_of_family(family, text(row[6])); !fault.empty())
      faulty.push_back({std::move(family), std::move(fault)});
  });
  return faulty;
}

void write_rows(pqxx::work& transaction, const std::filesystem::path& path) {
  std::filesystem::remove(path);
  Database database(path);
  prepare_tables(database);
  OwnerTable owners(database);
  {
    Transaction all(database);
    for_each_row(
        transaction, "id, created, description, bytes, used", "meshes", "true", rows_without_requests,
        [&](const pqxx::row& row) {
          insert_mesh(database, {text(row[0]), integer(row[1]), text(row[2])}, integer(row[3]));
          Statement(database, "UPDATE meshes SET used = ? WHERE id = ?").bind(integer(row[4])).bind(text(row[0])).run();
        });
    for (const auto& row : transaction.exec("SELECT mesh, owner FROM mesh_owners"))
      owners.add(OwnerTable::Kind::mesh, text(row[0]), text(row[1]));
    for_each_row(transaction, family_columns(), "families", "true", rows_with_requests,
                 [&](const pqxx::row& row) { insert_family(database, read_shared_family(row), text(row[6])); });
    for_each_row(transaction, shared_job_columns() + columns_of_end, "jobs", "true", rows_with_requests,
                 [&](const pqxx::row& row) {
                   const auto job = read_shared_job(row);
                   const auto end = row.column_number("bytes");
                   const ResultFile file{text(row[end + 3]), integer(row[end])};
                   insert_job(database, job, file.bytes, owners);
                   if (!file.hash.empty()) {
                     Result result;
                     result.content_type = text(row[end + 1]);
                     split_headers(text(row[end + 2]), result);
                     update_ended_job(database, job, &result, file);
                   }
                   if (row[end + 4].is_null()) return;
                   Statement(database, "INSERT INTO requests (job, content) VALUES (?, ?)")
                       .bind(job.id)
                       .bind_bytes(bytes(row[end + 4]))
                       .run();
                 });
    all.commit();
  }
  // The database is one file without log and index until a server opens it.
  database.execute("PRAGMA journal_mode = DELETE");
}

void read_rows(pqxx::work& transaction, const Database& database) {
  for (Statement row(database,
                     "SELECT id, created, max(created, used), bytes, description FROM meshes ORDER BY sequence");
       row.step();) {
    transaction.exec_params("INSERT INTO meshes (id, created, used, bytes, description) VALUES ($1, $2, $3, $4, $5)",
                            row.text(0), row.integer(1), row.integer(2), row.integer(3), row.text(4));
  }
  for (Statement row(database,
                     "SELECT owners.id, owner FROM owners JOIN meshes ON meshes.id = owners.id WHERE kind = 'mesh'");
       row.step();)
    transaction.exec_params("INSERT INTO mesh_owners (mesh, owner) VALUES ($1, $2)", row.text(0), row.text(1));
  for (Statement row(database, "SELECT " + family_columns() + " FROM families ORDER BY sequence"); row.step();)
    insert_shared_family(transaction, read_family(row), row.text(6));
  for (Statement row(database, "SELECT " + job_columns_to_read() +
                                   ", bytes, result_type, result_headers, result_hash, "
                                   "(SELECT content FROM requests WHERE job = jobs.id) FROM jobs ORDER BY sequence");
       row.step();) {
    const auto job = read_job(row);
    constexpr int end = 19;  // number of columns that read_job reads
    insert_shared_job(transaction, job, row.integer(end), {}, row.text(end + 4));
    transaction.exec_params("UPDATE jobs SET result_type = $2, result_headers = $3, result_hash = $4 WHERE id = $1",
                            job.id, row.text(end + 1), row.text(end + 2), row.text(end + 3));
  }
}

}  // namespace supple::store
