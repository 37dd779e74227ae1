#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "supple/store/store.h"

namespace supple::store {

/// A store that several servers use together: a PostgreSQL database for everything that is searched and for small
/// requests, and a folder that all servers see for meshes, results and large requests.
///
/// Each job is leased to one server, under a fencing token that grows each time that a server takes the job. A server
/// that has not been heard of for `lease` loses its jobs to others. What it still reports about them is refused,
/// because their tokens have grown. The file name of a result contains the token, so that a late result replaces
/// nothing.
///
/// Objects expire by the servers' clocks, leases by the clock of the database. After a connection was lost, the next
/// call makes a new one. Files that no row names are moved into the subfolder "quarantine" when they are older than
/// `orphan_age`.
class SharedStore final : public Store {
 public:
  struct Options {
    std::string database;  ///< connection string of libpq: "postgresql://user@host/name", or "host=... dbname=..."
    std::filesystem::path folder;     ///< the same for all servers
    double lease = 10;                ///< seconds after which a server that was not heard of loses its jobs
    double transaction_timeout = 20;  ///< seconds after which a transaction without an answer is given up
    Quota quota;                      ///< limits for all servers together
    double recount_interval = 5;      ///< seconds after which the stored bytes are counted again
    double orphan_age = 3600;         ///< seconds after which a file that no row names is moved into quarantine
    std::function<void(const std::string&)> warn;
  };

  /// Makes tables and folder where they do not exist. Throws "store.unavailable" where the database does not answer,
  /// has tables of a later version, or belongs to another folder, and where a LocalStore uses the folder.
  explicit SharedStore(const Options& options);
  ~SharedStore() override;

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
  bool is_shared() const override { return true; }
  std::vector<HeldJob> keep_holds(const std::vector<JobProgress>& running) override;
  std::vector<JobRecord> take_jobs(std::size_t max_count) override;
  std::optional<JobProgress> job_progress(const std::string& id) const override;
  std::optional<JobRecord> dismiss_job(const std::string& id, std::int64_t finished, std::int64_t expires) override;
  bool has_unfinished_job_on(const std::string& mesh) const override;
  bool still_has_mesh(const std::string& id) const override;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace supple::store
