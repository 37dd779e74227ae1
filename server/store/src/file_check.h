#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "data_folder.h"
#include "stored_files.h"
#include "supple/store/maintenance.h"

namespace supple::store {

/// A sentence about a file that is missing or differs from its row; empty where it does not.
std::string fault_on_disk(const StoredFile& file, const DataPaths& paths);

/// The files of a data folder that are not in `named`, and for which `is_named` is false.
std::vector<std::filesystem::path> orphaned_files(const DataPaths& paths,
                                                  const std::function<bool(const StoredFile&)>& is_named,
                                                  const std::set<std::filesystem::path>& named = {});

/// Compares every file that a catalogue names with its hash, and looks for files that it does not name. Servers may add
/// and remove files meanwhile. Adds what it finds to `check`.
void check_files(const DataPaths& paths, const Catalogue& catalogue, CheckReport& check);

}  // namespace supple::store
