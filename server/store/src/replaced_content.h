#pragma once

#include <filesystem>
#include <set>
#include <utility>
#include <vector>

#include "data_folder.h"

namespace supple::store {

/// What a restored backup would replace in a data folder: all but its lock, its quarantine, empty folders, and what
/// `stays`.
std::vector<std::filesystem::path> content_of(const Places& places, const std::set<std::filesystem::path>& stays = {});

/// Where what is replaced now belongs: a folder in quarantine that is not made yet.
std::filesystem::path place_of_replaced(const Places& places);

/// Files and folders that are moved, and moved back where not all of it succeeds.
class Moves {
 public:
  /// Makes the folder of `to`; an empty folder of that name makes room. Throws std::filesystem::filesystem_error.
  void move(const std::filesystem::path& from, const std::filesystem::path& to);
  void undo() noexcept;

 private:
  std::vector<std::pair<std::filesystem::path, std::filesystem::path>> done_;
};

}  // namespace supple::store
