#pragma once

#include <filesystem>
#include <set>
#include <utility>
#include <vector>

#include "data_folder.h"

namespace supple::store {

/// The content of a data folder that a restored backup would replace: everything but its lock, its quarantine, empty
/// folders, and `excluded`.
std::vector<std::filesystem::path> content_of(const DataPaths& paths,
                                              const std::set<std::filesystem::path>& excluded = {});

/// Path of a folder in quarantine for content that is replaced now. The folder does not exist yet.
std::filesystem::path quarantine_folder_of_replaced(const DataPaths& paths);

/// Moves files and folders, and can move them back if a later move fails.
class Moves {
 public:
  /// Makes the parent folder of `to`, and removes an empty folder at `to`. Throws std::filesystem::filesystem_error.
  void move(const std::filesystem::path& from, const std::filesystem::path& to);
  void undo() noexcept;

 private:
  std::vector<std::pair<std::filesystem::path, std::filesystem::path>> done_;
};

}  // namespace supple::store
