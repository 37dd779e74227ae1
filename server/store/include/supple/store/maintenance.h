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

}  // namespace supple::store
