#pragma once

#include <filesystem>
#include <pqxx/pqxx>
#include <string>
#include <vector>

#include "database.h"
#include "family_rows.h"
#include "stored_files.h"
#include "supple/store/maintenance.h"

namespace supple::store {

/// The files that the rows of a shared store name, in the order of Catalogue::files, with their sizes.
std::vector<StoredFile> shared_files(pqxx::work& transaction);

/// Whether the rows name a file of this kind and stem, or its job is unfinished and may be about to write it. Waits for
/// a server that is removing its row.
bool is_named_by_shared_rows(pqxx::work& transaction, const StoredFile& file);

/// A row of a job that no server leaves like this.
struct FaultyRow {
  std::string id;
  std::string fault;    ///< a sentence
  std::string request;  ///< the damaged request; empty where the row contradicts itself
};

/// Checks each job, and each request that is in the database. The requests are counted in `check`.
std::vector<FaultyRow> faulty_rows(pqxx::work& transaction, CheckReport& check);

/// The rows of families that do not have their hash. The families are counted in `check`.
std::vector<FaultyFamily> faulty_families(pqxx::work& transaction, CheckReport& check);

/// Writes all rows into a new database of a data folder, in the tables of LocalStore.
void write_rows(pqxx::work& transaction, const std::filesystem::path& database);

/// Adds the rows of a data folder's database to the tables of a shared store, which are empty. The tables of `database`
/// have been prepared.
void read_rows(pqxx::work& transaction, const Database& database);

}  // namespace supple::store
