#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "supple/store/store.h"

namespace supple::store {

/// A store of one server, in one folder: an SQLite database (write-ahead log) for what is
/// searched and for small requests, one file for each mesh, each result, and each request of a job that has not ended.
///
/// A file is written beside its place, synchronized, and renamed; its row is committed afterwards. So a row's file is
/// always complete, whenever the process or the machine stops. The file of a small request is a spare one beside what
/// the database has: it outlives the process and the database, and only where the machine stops and the database is
/// lost as well, those of the last seconds may be lost with it. Files of results and requests begin with what their
/// rows say of them.
///
/// At the start the database is looked through. A damaged one is moved into the folder "quarantine" and a new one is
/// made. Files without a row get a row again: meshes whose name is their hash, results whose own hashes are right, and,
/// where the database is new, requests. Every other file that no row knows is moved into quarantine. Removed is
/// only what was never acknowledged, or is no longer needed: half-written files, the result of an unfinished job, the
/// request of a finished one.
///
/// Removing works on a full disk too, in the place of a reserve that is held for that.
class LocalStore final : public Store {
 public:
  /// What the store needs in order to recover at the start.
  struct Recovery {
    /// Makes the description of a mesh anew from its file. Without it, or where it throws, the file goes into
    /// quarantine.
    std::function<std::string(const std::string& ply, const std::string& id, std::int64_t created)> describe;
    std::function<void(const std::string&)> warn;  ///< hears what was found and what became of it
  };

  /// Opens or makes the folder. Throws also where another process has it open.
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
  std::size_t remove_expired_jobs(std::int64_t now, std::size_t most) override;
  void take_reserve() override;
  Usage usage() const override;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace supple::store
