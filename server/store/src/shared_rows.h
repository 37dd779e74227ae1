#pragma once

#include <filesystem>
#include <pqxx/pqxx>
#include <string>
#include <vector>

#include "database.h"
#include "stored_files.h"
#include "supple/store/maintenance.h"

namespace supple::store {

/// The files that the rows of a shared store name, in the order of Catalogue::files, with their bytes.
std::vector<StoredFile> shared_files(pqxx::work& transaction);

/// Whether the rows name a file by its kind and its stem, or its job has not ended and may be about to write it. Waits
/// for a server that is removing its row.
bool shared_rows_name(pqxx::work& transaction, const StoredFile& file);

/// A row of a job that is not as a server leaves it.
struct FaultyRow {
  std::string id;
  std::string fault;    ///< a sentence
  std::string request;  ///< the damaged request; empty where the row contradicts itself
};

/// Looks at each job, and at each request that is in the database, which is counted in `check`.
std::vector<FaultyRow> faulty_rows(pqxx::work& transaction, Check& check);

/// Writes all rows into a new database of a data folder, as LocalStore keeps them.
void write_rows(pqxx::work& transaction, const std::filesystem::path& database);

/// Adds the rows of a data folder's database, whose tables are prepared, to tables that are empty.
void read_rows(pqxx::work& transaction, const Database& database);

}  // namespace supple::store
