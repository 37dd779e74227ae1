#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "data_folder.h"
#include "stored_files.h"
#include "supple/store/maintenance.h"

namespace supple::store {

/// Throws "store.unavailable" unless the folder is empty or does not exist.
void require_empty(const std::filesystem::path& folder);

/// Makes the folders of a store where they do not exist. Only the server's user may enter them.
void make_folders(const DataPaths& paths);

/// Copies a database as it is at this moment to `to`. Others may write to `from` meanwhile.
void copy_database(const std::filesystem::path& from, const std::filesystem::path& to);

/// Name of a file, without its suffix, in the data folder of a LocalStore.
inline std::string stem_in_data_folder(const StoredFile& file) { return file.id; }

/// Copies the files of a store.
class Copier {
 public:
  /// `stem` returns the file name of the copy of a file, without its suffix.
  Copier(DataPaths from, DataPaths to, std::string (*stem)(const StoredFile&))
      : from_{std::move(from)}, to_{std::move(to)}, stem_{stem} {}

  /// Copies the files, except those that were copied before: stored files do not change. Returns the files that do not
  /// exist.
  std::vector<StoredFile> copy_files(const std::vector<StoredFile>& files);
  std::size_t copied() const { return copied_.size(); }

  /// Completes the copy, whose database is in place and whose files are copied. Removes copies that only earlier states
  /// of the database named, copies the other files of the data folder, and reports what is missing.
  CopyReport finish(const std::vector<StoredFile>& missing);

 private:
  void remove_obsolete_copies();

  const DataPaths from_;
  const DataPaths to_;
  std::string (*const stem_)(const StoredFile&);
  std::set<std::filesystem::path> copied_;   ///< paths of the copies
  std::set<std::filesystem::path> current_;  ///< paths of the copies that the last call of copy_files asked for
  CopyReport copy_;
};

}  // namespace supple::store
