#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "supple/store/local_store.h"

namespace supple::store {

/// What a look through a data folder has found.
struct Check {
  std::size_t meshes = 0;           ///< that the database names
  std::size_t results = 0;          ///< likewise
  std::size_t requests = 0;         ///< likewise: of jobs that have not ended
  std::vector<std::string> faults;  ///< sentences, each of which names a file
};

/// Looks through the database of a data folder and compares every file that it names with its hash; files that it does
/// not name are faults too. Changes nothing; a server may use the folder meanwhile. O(bytes stored). Throws
/// "store.unavailable" where there is no database.
Check check_folder(const std::filesystem::path& folder);

/// Makes a data folder sound that no server uses, and returns what was wrong with it. Does what every start does (see
/// Store); then what does not have its hash is moved into quarantine. Its mesh is no longer known, so that it can be
/// sent again, its job has failed with what `problem` makes of a sentence, and a job that waits without its request is
/// interrupted at the next start. Nothing is deleted. O(bytes stored). Throws as LocalStore does.
Check repair_folder(const std::filesystem::path& folder, const LocalStore::Recovery& recovery,
                    const std::function<std::string(const std::string& sentence)>& problem);

/// What was copied.
struct Copy {
  std::size_t files = 0;
  std::int64_t bytes = 0;
  std::vector<std::string> faults;  ///< sentences about what the original lacks or has damaged; it is copied as it is
};

/// Copies a data folder as it is at one moment into a folder that is empty or does not exist, durably. A server may use
/// the data folder meanwhile: of what comes and goes during the copy all or nothing is in it. A file "backup" is
/// written last. O(bytes stored). Throws "store.unavailable", "store.full", std::filesystem::filesystem_error.
Copy back_up(const std::filesystem::path& folder, const std::filesystem::path& to);

/// Copies a backup into a data folder that is empty or does not exist. With `replace`, what is in the folder goes into
/// its quarantine first. O(bytes stored). Throws as back_up does, and where `from` is no complete backup, or another
/// process uses the data folder.
Copy restore(const std::filesystem::path& from, const std::filesystem::path& folder, bool replace);

/// Where a shared store is: see SharedStore::Options.
struct SharedPlace {
  std::string database;  ///< connection string of libpq
  std::filesystem::path folder;
};

/// Does for a shared store what check_folder does for a local one: looks through the rows, also of requests in the
/// database, and through the folder. Servers may use both meanwhile. Throws "store.unavailable" where the database does
/// not answer, has no store or one of a later version, or belongs to another folder.
Check check_shared_store(const SharedPlace& store);

/// Does for a shared store what repair_folder does for a local one. What the database does not name is moved into
/// quarantine. A job whose request is damaged or missing has failed too, and so has one whose row contradicts itself.
/// Throws as check_shared_store does, and "store.unavailable" where a server uses the store: one that has the folder,
/// or that the database has heard of within its lease.
Check repair_shared_store(const SharedPlace& store, const std::function<void(const std::string&)>& warn,
                          const std::function<std::string(const std::string& sentence)>& problem);

/// Does for a shared store what back_up does for a local one. The backup is a data folder with a database of its own,
/// as back_up makes it, so that check_folder, restore and a server understand it: rows as one transaction (REPEATABLE
/// READ) saw them, and all the files that they name. What servers store and remove waits for the moment in which the
/// last few files are copied. How far unfinished jobs are is not in it.
Copy back_up_shared_store(const SharedPlace& store, const std::filesystem::path& to);

/// Does what restore does, into a shared store, whose tables and folder are made where they do not exist. Each job that
/// has not ended is free for any server. The files are copied and compared with their hashes before anything is
/// replaced: a damaged backup replaces nothing ("store.corrupted"), but its sound part fills an empty store. The rows
/// that are replaced go into quarantine too, as a database. Throws "store.unavailable" where the store is not empty
/// without `replace`, and where a server uses it, as repair_shared_store does. Where the database is lost in the moment
/// of its commit, rows and files may be of different stores: then the same call with `replace` restores both.
Copy restore_shared_store(const std::filesystem::path& from, const SharedPlace& store, bool replace);

}  // namespace supple::store
