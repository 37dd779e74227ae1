#pragma once

#include "data_folder.h"
#include "database.h"
#include "supple/store/local_store.h"

namespace supple::store {

/// Opens the database of a data folder and looks through it. A damaged one, or what is left of a lost one, is moved
/// into quarantine, and a new one is made; `is_new` tells so. Throws "store.unavailable", "store.full".
std::unique_ptr<Database> open_database(const DataFolder& folder, bool& is_new);

/// Brings a data folder and its database together at the start: see Store. `is_new` says that the database was made
/// now, so that it knows nothing of the files.
void recover_files(const DataFolder& folder, Database& database, const LocalStore::Recovery& recovery, bool is_new);

}  // namespace supple::store
