#pragma once

#include <string>
#include <vector>

#include "data_folder.h"
#include "database.h"

namespace supple::store {

/// A file that the database of a data folder names.
struct StoredFile {
  enum class Kind { mesh, result, request };
  Kind kind;
  std::string id;    ///< of the mesh or the job
  std::string hash;  ///< of the content: all of a mesh, the body of a result; empty for a request, which has its own

  std::filesystem::path place(const Places& places) const;
};

/// All of them, requests first, for they are the first to go; of each kind the oldest first.
std::vector<StoredFile> stored_files(const Database& database);

/// A sentence about a content that does not have its hash; empty where it is as it should be.
std::string fault_of(const StoredFile& file, const std::string& name, std::string_view content);

}  // namespace supple::store
