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
    std::function<std::string(const std::string& ply, const std::string& id, std::int64_t created)> describe;
    std::function<void(const std::string&)> warn;  ///< receives sentences about what was found and done
  };

  /// Opens the folder, or makes it. Throws also where another process has it open.
  explicit LocalStore(const std::filesystem::path& folder, const Recovery& recovery = {}, const Quota& quota = {});
  ~LocalStore() override;

  std::pair<MeshRecord, bool> add_mesh(const std::string& ply, const DescribeMesh& describe,
                                       const std::string& owner = {}) override;
  std::optional<MeshRecord> mesh(const std::string& id) const override;
  std::vector<MeshRecord> meshes(std::size_t limit, const std::string& after,
                                 const std::string& owner = {}) const override;
  std::string mesh_content(const std::string& id, const CancellationToken& cancellation = {}) const override;
  OpenContent open_mesh_content(const std::string& id, const CancellationToken& cancellation = {}) const override;
  bool remove_mesh(const std::string& id, const std::string& owner = {}) override;
  bool owns_mesh(const std::string& id, const std::string& owner) const override;
  bool is_last_owner_of_mesh(const std::string& id, const std::string& owner) const override;
  void use_mesh(const std::string& id) const override;
  std::vector<std::string> remove_unused_meshes(std::int64_t before) override;
  std::string keep_request(const JobRecord& job, const JobRequest& request, std::string_view body) override;
  void drop_request(const std::string& id) override;
  bool has_request(const std::string& id) const override;
  StoredRequest job_request(const std::string& id) const override;
  bool add_job(const JobRecord& job, const std::string& request = {}) override;
  bool note_progress(const JobRecord& job) override;
  bool finish_job(const JobRecord& job, const Result* result) override;
  std::optional<JobRecord> job(const std::string& id) const override;
  std::vector<JobRecord> jobs(const std::vector<JobState>& states, std::size_t limit, const std::string& after,
                              const std::string& owner = {}) const override;
  std::optional<JobRecord> job_of_key(const std::string& key) const override;
  bool owns_job(const std::string& id, const std::string& owner) const override;
  StoredResult job_result(const std::string& id) const override;
  bool remove_job(const std::string& id) override;
  std::vector<JobRecord> unfinished_jobs() const override;
  std::size_t remove_expired_jobs(std::int64_t now, std::size_t max_count) override;
  void take_reserve() override;
  Usage usage() const override;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace supple::store
