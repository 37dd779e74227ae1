#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "data_folder.h"
#include "database.h"

namespace supple::store {

/// A file that the database of a store names.
struct StoredFile {
  enum class Kind { mesh, result, request };
  Kind kind;
  std::string id;  ///< id of the mesh or the job
  /// Hash of the whole file of a mesh, or of the body of a result. Empty for a request, whose file has its hash.
  std::string hash;
  std::string stem = id;    ///< name of the file without its suffix
  std::int64_t bytes = -1;  ///< size of the file according to its row; negative where the row has none

  std::filesystem::path path(const DataPaths& paths) const;
};

/// The files that a database names.
struct Catalogue {
  /// All files: the requests first, which are the first to be removed. Files of one kind are in the order of their age,
  /// the oldest first.
  std::function<std::vector<StoredFile>()> files;
  /// Whether a file of this kind and stem is one of them, or may be about to be written.
  std::function<bool(const StoredFile&)> contains;
};

/// The catalogue of a data folder with a database of its own. `database` must outlive it.
Catalogue catalogue_of(const Database& database);

/// A sentence about content that does not have its hash; empty where it has.
std::string fault_of(const StoredFile& file, const std::string& name, std::string_view content);

}  // namespace supple::store
