#pragma once

#include "data_folder.h"

namespace supple::store {

/// Writes the file "backup", with a description of the backup and the hash of its database. It is written last: a
/// backup without it is incomplete. Throws as write_stored_file does.
void write_backup_marker(const DataPaths& backup, std::size_t files, std::int64_t bytes);

/// Updates the hash of the database in the file "backup", after a repair. Does nothing in a folder without this file.
void renew_backup_marker(const DataPaths& folder);

/// Throws "store.unavailable" for a folder that is no complete backup, "store.corrupted" where its database has
/// changed. Backups of earlier versions have no hash of it.
void require_backup(const DataPaths& folder);

}  // namespace supple::store
