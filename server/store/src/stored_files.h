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
  std::string id;           ///< of the mesh or the job
  std::string hash;         ///< of all of a mesh, of the body of a result; empty for a request, which has its own
  std::string stem = id;    ///< name of the file without its suffix
  std::int64_t bytes = -1;  ///< of the file, as its row says; negative where it does not say it

  std::filesystem::path place(const Places& places) const;
};

/// What a database says of the files of its store.
struct Catalogue {
  /// All of them, requests first, for they are the first to go; of each kind the oldest first.
  std::function<std::vector<StoredFile>()> files;
  /// Whether the file, by its kind and its stem, is one of them or is about to be.
  std::function<bool(const StoredFile&)> names;
};

/// The catalogue of a data folder with a database of its own. `database` outlives it.
Catalogue catalogue_of(const Database& database);

/// A sentence about a content that does not have its hash; empty where it is as it should be.
std::string fault_of(const StoredFile& file, const std::string& name, std::string_view content);

/// "The stored file `name` is missing."
std::string missing_file(const std::string& name);

}  // namespace supple::store
