#pragma once

#include "data_folder.h"

namespace supple::store {

/// Writes the file "backup" of a backup: what it is, and the hash of its database. It is written last, so that a backup
/// without it is known to be incomplete. Throws as write_stored_file does.
void write_backup_marker(const Places& backup, std::size_t files, std::int64_t bytes);

/// Writes the hash of the database anew into the file "backup" of a folder that has one, after a repair.
void renew_backup_marker(const Places& folder);

/// Throws "store.unavailable" for a folder that is no complete backup, "store.corrupted" where its database is not the
/// one that was written. Backups of earlier versions do not tell its hash.
void require_backup(const Places& folder);

}  // namespace supple::store
