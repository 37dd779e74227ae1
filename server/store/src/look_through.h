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

/// A sentence about a file that is missing or is not what its row says; empty where it is as it should be.
std::string fault_on_disk(const StoredFile& file, const Places& places);

/// The files of a folder that are not `known`, and that `names` does not tell of either.
std::vector<std::filesystem::path> unknown_files(const Places& places,
                                                 const std::function<bool(const StoredFile&)>& names,
                                                 const std::set<std::filesystem::path>& known = {});

/// Compares every file that a catalogue names with its hash, and looks for those that it does not name, while servers
/// may add and remove some. Adds what it finds to `check`.
void look_through(const Places& places, const Catalogue& catalogue, Check& check);

}  // namespace supple::store
