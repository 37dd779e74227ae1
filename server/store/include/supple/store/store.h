#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/store/clock.h"
#include "supple/store/open_content.h"
#include "supple/store/records.h"

namespace supple::store {

/// SHA-256 in hexadecimal. Checks for a stop request every few milliseconds.
std::string sha256(std::string_view bytes, const CancellationToken& cancellation = {});

/// Limits of stored bytes; 0: no limit.
struct Quota {
  std::int64_t bytes = 0;       ///< bytes of the whole data folder; setting --max-store
  std::int64_t mesh_bytes = 0;  ///< bytes of meshes; setting --max-mesh-bytes
  /// Limit for one owner: the meshes that it owns, each counted in full, its families, and results and requests of its
  /// jobs; setting --max-stored of its key. Called from any thread.
  std::function<std::int64_t(const std::string& owner)> owner_limit{};
};

/// Nine tenths of the size of the disk that a data folder is on, or would be on; 0 where it is unknown. Present free
/// space does not count, so that nothing expires because others fill the disk.
std::int64_t default_quota(const std::filesystem::path& folder);

/// Bytes that are stored in a data folder.
struct Usage {
  std::int64_t meshes = 0;
  std::int64_t results = 0;
  std::int64_t requests = 0;    ///< files of requests of unfinished jobs
  std::int64_t database = 0;    ///< with its log and its index, all families, and the reserve file for a full disk
  std::int64_t quarantine = 0;  ///< counted at the start and at each removal of expired jobs
  std::int64_t limit = 0;       ///< limit for the total; 0: none
  std::int64_t mesh_limit = 0;  ///< limit for meshes; 0: none
  std::int64_t total() const { return meshes + results + requests + database + quarantine; }
};

/// Meshes and their owners.
class MeshStore {
 public:
  virtual ~MeshStore() = default;

  using DescribeMesh = std::function<std::string(const std::string& id, std::int64_t created)>;
  /// Stores a mesh, whose id is the hash of `ply`, with the description that `describe` makes. Returns the record, and
  /// whether it is new. A mesh that is stored already does not change. If `owner` is not empty, it becomes one of the
  /// mesh's owners in the same transaction, and a mesh counts as new if the owner did not own it before.
  virtual std::pair<MeshRecord, bool> add_mesh(const std::string& ply, const DescribeMesh& describe,
                                               const std::string& owner = {}) = 0;
  virtual std::optional<MeshRecord> mesh(const std::string& id) const = 0;
  /// The newest `limit` meshes, of one owner if `owner` is not empty. `after` is the last id of the previous page.
  virtual std::vector<MeshRecord> meshes(std::size_t limit, const std::string& after,
                                         const std::string& owner = {}) const = 0;
  /// The mesh as canonical PLY. Throws "mesh.not_found", "store.corrupted", and the error of a stop request.
  virtual std::string mesh_content(const std::string& id, const CancellationToken& cancellation = {}) const = 0;
  /// The same as an open file, to be read in pieces. Takes a mebibyte of memory for a mesh of any size.
  virtual OpenContent open_mesh_content(const std::string& id, const CancellationToken& cancellation = {}) const = 0;
  /// Removes a mesh; false where there was none. If `owner` is not empty, it stops being an owner of the mesh, and the
  /// mesh is removed with its last owner.
  virtual bool remove_mesh(const std::string& id, const std::string& owner = {}) = 0;
  virtual bool owns_mesh(const std::string& id, const std::string& owner) const = 0;
  /// Whether remove_mesh for this owner would remove the mesh itself.
  virtual bool is_last_owner_of_mesh(const std::string& id, const std::string& owner) const = 0;
  /// Notes that a mesh is used now, in a microsecond. The database gets the time before unused meshes are removed.
  virtual void note_mesh_use(const std::string& id) const = 0;
  /// Removes the meshes that nobody has used since `before`, in milliseconds since 1970, and on which no unfinished job
  /// works. Returns their ids.
  virtual std::vector<std::string> remove_unused_meshes(std::int64_t before) = 0;
  /// False where another server has removed the mesh, which may take a second to be noticed.
  virtual bool may_have_mesh(const std::string& /*id*/) const { return true; }
};

/// Families of tilings that clients have added. Each owner has its own, which nobody else sees. They are rows of the
/// database, since a definition has a few kilobytes.
class FamilyStore {
 public:
  /// Number of families that one owner may have.
  static constexpr std::int64_t max_families = 256;

  virtual ~FamilyStore() = default;

  /// Stores a family, which gets its id here, durably once this returns. Returns the record, and whether it is new: a
  /// family of the owner with the same name and definition does not change. Throws "family.exists" where the owner has
  /// another family of this name, "family.too_many", "store.quota" and "store.key_quota".
  virtual std::pair<FamilyRecord, bool> add_family(FamilyRecord family) = 0;
  /// Throws "store.corrupted" for a row that has changed since it was written.
  virtual std::optional<FamilyRecord> family(const std::string& owner, const std::string& name) const = 0;
  /// All families of an owner, the oldest first. Their content is not compared with its hash.
  virtual std::vector<FamilyRecord> families(const std::string& owner) const = 0;
  /// Removes a family; false where there was none. Throws "family.in_use" where an unfinished job needs it.
  virtual bool remove_family(const std::string& owner, const std::string& name) = 0;
};

/// Jobs and their owners.
class JobStore {
 public:
  virtual ~JobStore() = default;

  /// Adds a job with its owner; durable once this returns. `request` is what store_request has returned. False, and
  /// nothing is added, where another job has the same idempotency key. Throws "tiling.family_not_found" where a family
  /// that the job needs was removed meanwhile.
  virtual bool add_job(const JobRecord& job, const std::string& request = {}) = 0;
  /// Stores state, start and attempts of an unfinished job; does nothing for a finished one. They survive the end of
  /// the process, but not necessarily of the machine. In a shared store, a job in the state "accepted" is given back
  /// for any server to take. False where another server has taken or ended the job.
  virtual bool update_job(const JobRecord& job) = 0;
  /// Commits the end of a job, with its result if it has one, and removes its request. Durable once this returns.
  /// False, and nothing changes, where the job is gone or another server has it.
  virtual bool finish_job(const JobRecord& job, const Result* result) = 0;
  virtual std::optional<JobRecord> job(const std::string& id) const = 0;
  /// The newest `limit` jobs in one of the states, or in any state where `states` is empty; of one owner if `owner` is
  /// not empty. `after` is the last id of the previous page.
  virtual std::vector<JobRecord> jobs(const std::vector<JobState>& states, std::size_t limit, const std::string& after,
                                      const std::string& owner = {}) const = 0;
  /// The job with this idempotency key.
  virtual std::optional<JobRecord> job_of_key(const std::string& key) const = 0;
  virtual bool owns_job(const std::string& id, const std::string& owner) const = 0;
  virtual bool remove_job(const std::string& id) = 0;
  /// Jobs that an earlier process left unfinished, the oldest first. A shared store returns none, for other servers may
  /// run them.
  virtual std::vector<JobRecord> unfinished_jobs() const = 0;
  /// Removes finished jobs that have expired by `now`, and the oldest finished ones beyond `max_count`. Returns their
  /// number.
  virtual std::size_t remove_expired_jobs(std::int64_t now, std::size_t max_count) = 0;
};

/// Requests and results of jobs.
class BlobStore {
 public:
  virtual ~BlobStore() = default;

  /// Stores the request from which a later process can make the job again. A large one goes to a file, durably once
  /// this returns. A small one is returned for add_job, which stores it in the database with the job; a local store
  /// also writes a copy to a file, in case the database is lost. If the job is not added, the caller removes the
  /// request.
  virtual std::string store_request(const JobRecord& job, const JobRequest& request, std::string_view body) = 0;
  virtual void remove_request(const std::string& id) = 0;
  virtual bool has_request(const std::string& id) const = 0;
  /// Throws "store.corrupted".
  virtual StoredRequest job_request(const std::string& id) const = 0;
  /// The result of a job. Its body has been compared with its hash, and is open; that takes a mebibyte of memory for
  /// any size. Throws "job.not_found", "store.corrupted".
  virtual StoredResult job_result(const std::string& id) const = 0;
};

/// The leases of jobs, where several servers use the store. Each job is leased to one server, which has to renew its
/// leases every few seconds.
class LeaseStore {
 public:
  virtual ~LeaseStore() = default;

  /// Renews the lease of this server, and stores the progress of its jobs and the times at which meshes were used.
  /// Returns the jobs that are leased to it.
  virtual std::vector<LeasedJob> renew_leases(const std::vector<JobProgress>& running) = 0;
  /// Leases jobs to this server, the most urgent first and of those the oldest: those of servers that have not been
  /// heard of, then as many of those that wait at other servers as its workers could start. Each kind counts by itself:
  /// the jobs in the background, and the others.
  virtual std::vector<JobRecord> lease_jobs(const IdleWorkers& idle) = 0;
  /// Progress of a job that another server runs.
  virtual std::optional<JobProgress> job_progress(const std::string& id) const = 0;
  /// Ends an unfinished job as dismissed, whichever server has it. Nullopt where there is no such job.
  virtual std::optional<JobRecord> dismiss_job(const std::string& id, std::int64_t finished, std::int64_t expires) = 0;
  virtual bool has_unfinished_job_on(const std::string& mesh) const = 0;
};

/// Durable storage of meshes, families and jobs, in parts.
///
/// If new bytes would exceed the quota, the oldest results expire. Where that does not free enough, ProblemError
/// "store.quota" is thrown. The limit of one owner works alike, with its own results and "store.key_quota".
///
/// Content is compared with its hash whenever it is read: StoreCorrupted names a file that has changed. Every member of
/// every part throws StoreFull where the disk is full, StoreUnavailable where the disk or the database fails otherwise
/// (store_error.h). Any thread may call. Calls of the database run one after the other; files are read and written
/// meanwhile.
class Store {
 public:
  Store() = default;
  virtual ~Store() = default;
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  virtual MeshStore& meshes() const = 0;
  virtual JobStore& jobs() const = 0;
  virtual BlobStore& blobs() const = 0;
  /// Null where one server alone uses the store.
  virtual LeaseStore* leases() const { return nullptr; }

  /// Makes the reserve file again, which was deleted on a full disk, once there is space. Takes a microsecond where it
  /// exists.
  virtual void refill_reserve() = 0;
  /// The bytes that are stored now. Takes a few microseconds.
  virtual Usage usage() const = 0;
  virtual FamilyStore& families() const = 0;
};

}  // namespace supple::store
