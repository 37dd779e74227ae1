#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "supple/store/local_store.h"

namespace supple::store {

/// What a check of a data folder has found.
struct CheckReport {
  std::size_t meshes = 0;           ///< number that the database names
  std::size_t families = 0;         ///< number that the database has
  std::size_t results = 0;          ///< number that the database names
  std::size_t requests = 0;         ///< number of requests of unfinished jobs
  std::vector<std::string> faults;  ///< sentences, each of which names a file
};

/// Checks the database of a data folder and compares every file that it names with its hash. A file that it does not
/// name is a fault too. Changes nothing; a server may use the folder meanwhile. O(bytes stored). Throws
/// "store.unavailable" where there is no database.
CheckReport check_folder(const std::filesystem::path& folder);

/// Repairs a data folder that no server uses, and returns what was wrong with it. It first does what every start does
/// (see LocalStore). Then it moves each file that does not have its hash into quarantine. The row of a damaged mesh is
/// removed, so that the mesh can be uploaded again; that of a damaged family too. A job whose result is damaged has
/// failed; `problem` makes its error of a sentence. A job whose request is damaged is interrupted at the next start.
/// Nothing is deleted. O(bytes stored). Throws as LocalStore does.
CheckReport repair_folder(const std::filesystem::path& folder, const LocalStore::Recovery& recovery,
                          const std::function<std::string(const std::string& sentence)>& problem);

/// Result of a copy.
struct CopyReport {
  std::size_t files = 0;
  std::int64_t bytes = 0;
  std::vector<std::string> faults;  ///< sentences about files that are missing or damaged in the original
};

/// Copies the state of a data folder at one moment into a folder that is empty or does not exist, durably. A server may
/// use the data folder meanwhile: an object that is added or removed during the copy is in it completely or not at all.
/// A damaged file is copied as it is. The file "backup" is written last. O(bytes stored). Throws "store.unavailable",
/// "store.full", std::filesystem::filesystem_error.
CopyReport back_up(const std::filesystem::path& folder, const std::filesystem::path& to);

/// Copies a backup into a data folder that is empty or does not exist. With `replace`, the previous content of the
/// folder is moved into its quarantine first. O(bytes stored). Throws as back_up does, where `from` is no complete
/// backup, and where another process uses the data folder.
CopyReport restore(const std::filesystem::path& from, const std::filesystem::path& folder, bool replace);

/// Location of a shared store; see SharedStore::Options.
struct SharedStoreLocation {
  std::string database;  ///< connection string of libpq
  std::filesystem::path folder;
};

/// Does for a shared store what check_folder does for a local one: checks the rows, with the requests in the database,
/// and the folder. Servers may use both meanwhile. Throws "store.unavailable" where the database does not answer, has
/// no store or one of a later version, or belongs to another folder.
CheckReport check_shared_store(const SharedStoreLocation& store);

/// Does for a shared store what repair_folder does for a local one. A file that the database does not name is moved
/// into quarantine. A job has failed if its request is damaged or missing, or if its row contradicts itself. Throws as
/// check_shared_store does, and "store.unavailable" where a server uses the store: one that has locked the folder, or
/// one whose lease in the database has not ended.
CheckReport repair_shared_store(const SharedStoreLocation& store, const std::function<void(const std::string&)>& warn,
                                const std::function<std::string(const std::string& sentence)>& problem);

/// Does for a shared store what back_up does for a local one, and makes a data folder as that does. It has the rows as
/// one transaction (REPEATABLE READ) saw them, and all files that they name. Servers that store or remove something
/// wait while the last few files are copied. The progress of unfinished jobs is not copied.
CopyReport back_up_shared_store(const SharedStoreLocation& store, const std::filesystem::path& to);

/// Does what restore does, into a shared store, whose tables and folder are made where they do not exist. Any server
/// may take the unfinished jobs. The files are copied and compared with their hashes before anything is replaced. A
/// damaged backup replaces nothing ("store.corrupted"), but its sound part fills an empty store. Replaced rows go into
/// quarantine too, as an SQLite database. Throws "store.unavailable" where the store is not empty and `replace` is not
/// set, and where a server uses it, as repair_shared_store does. If the database is lost during its commit, rows and
/// files may belong to different stores; the same call with `replace` then restores both.
CopyReport restore_shared_store(const std::filesystem::path& from, const SharedStoreLocation& store, bool replace);

}  // namespace supple::store
