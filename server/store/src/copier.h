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

/// Throws "store.unavailable" where there is something in a folder, or where it is none.
void require_empty(const std::filesystem::path& folder);

/// Makes the folders of a store where they do not exist, for the server's user alone.
void make_folders(const Places& places);

/// Makes `to` the database that `from` is at this moment, whoever writes to `from`.
void copy_database(const std::filesystem::path& from, const std::filesystem::path& to);

/// What a file is called in a folder with a database of its own.
inline std::string stem_in_data_folder(const StoredFile& file) { return file.id; }

/// Copies the files of a store.
class Copier {
 public:
  /// `stem` names the copy of a file.
  Copier(Places from, Places to, std::string (*stem)(const StoredFile&))
      : from_{std::move(from)}, to_{std::move(to)}, stem_{stem} {}

  /// Copies those of these files that have not been copied yet, for files do not change. Returns those that are not
  /// there.
  std::vector<StoredFile> copy_files(const std::vector<StoredFile>& files);
  std::size_t copied() const { return copied_.size(); }

  /// Ends the copy after the files of its rows, which are in its place: removes what only earlier rows named, adds what
  /// else is kept in a data folder, and tells what is missing.
  Copy finish(const std::vector<StoredFile>& missing);

 private:
  void remove_what_has_gone();

  const Places from_;
  const Places to_;
  std::string (*const stem_)(const StoredFile&);
  std::set<std::filesystem::path> copied_;  ///< their places in the copy
  std::set<std::filesystem::path> wanted_;  ///< by the files that were copied last
  Copy copy_;
};

}  // namespace supple::store
