#pragma once

#include "data_folder.h"
#include "database.h"
#include "supple/store/local_store.h"

namespace supple::store {

/// Opens the database of a data folder and checks it. A damaged one, or what is left of a lost one, is moved into
/// quarantine, and a new one is made; `is_new` says so. Throws "store.unavailable", "store.full".
std::unique_ptr<Database> open_database(const DataFolder& folder, bool& is_new);

/// Makes the files of a data folder and the rows of its database agree at the start; see LocalStore. `is_new` says that
/// the database was made just now and has no rows.
void recover_files(const DataFolder& folder, Database& database, const LocalStore::Recovery& recovery, bool is_new);

}  // namespace supple::store
