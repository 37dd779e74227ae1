#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "supple/store/store.h"

namespace supple::store {

/// The store of one server, in one folder: an SQLite database (with a write-ahead log) for everything that is searched
/// and for small requests, and a file for each mesh, each result and each request of an unfinished job.
///
/// A file is written under a temporary name, synchronized and renamed; its row is committed afterwards, so that a row's
/// file is always complete. The file of a small request is a second, unsynchronized copy of what the database has. It
/// survives the end of the process and the loss of the database. If the machine stops and the database is lost as well,
/// the requests of the last seconds may be lost. Files of results and requests begin with everything that their rows
/// say.
///
/// At the start the database is checked. A damaged one is moved into the folder "quarantine", and a new one is made.
/// Files without a row get one again: meshes whose name is their hash, results whose hashes are right and, where the
/// database is new, requests. Other files without a row are moved into quarantine. Files are deleted only if they were
/// never acknowledged or are not needed any more: half-written files, the result of an unfinished job, the request of a
/// finished one.
///
/// Removing works on a full disk too: the reserve file is deleted first, since a commit needs space.
class LocalStore final : public Store {
 public:
  /// Callbacks of the recovery at the start.
  struct Recovery {
    /// Makes the description of a mesh from its file. If it is empty or throws, the file is moved into quarantine.
    /// After std::bad_alloc, which says nothing about the file, it stays, and the next start tries again.
    std::function<std::string(const std::string& ply, const std::string& id, std::int64_t created)> describe;
    std::function<void(const std::string&)> warn;  ///< receives sentences about what was found and done
  };

  /// Opens the folder, or makes it. Throws also where another process has it open.
  explicit LocalStore(const std::filesystem::path& folder, const Recovery& recovery = {}, const Quota& quota = {});
  ~LocalStore() override;

  MeshStore& meshes() const override;
  FamilyStore& families() const override;
  JobStore& jobs() const override;
  BlobStore& blobs() const override;
  void refill_reserve() override;
  Usage usage() const override;

 private:
  struct Parts;
  const std::unique_ptr<Parts> parts_;
};

}  // namespace supple::store
