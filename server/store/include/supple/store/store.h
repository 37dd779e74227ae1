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

/// SHA-256 in hexadecimal. Looks at the token every few milliseconds.
std::string sha256(std::string_view bytes, const CancellationToken& cancellation = {});

/// Limits of what a store holds, in bytes; 0: none.
struct Quota {
  std::int64_t bytes = 0;       ///< of the whole data folder; setting --max-store
  std::int64_t mesh_bytes = 0;  ///< of meshes; setting --max-mesh-bytes
  /// Of what an owner holds: the meshes that it owns, each of them in full, and results and requests of its jobs;
  /// setting --max-stored of its key. Called from any thread.
  std::function<std::int64_t(const std::string& owner)> of_owner{};
};

/// Nine tenths of the disk that a data folder is on, or would be on: of its size, not of what is free just now, so that
/// nothing expires because others fill it. 0 where that cannot be told.
std::int64_t default_quota(const std::filesystem::path& folder);

/// Bytes that a data folder holds.
struct Usage {
  std::int64_t meshes = 0;
  std::int64_t results = 0;
  std::int64_t requests = 0;    ///< large ones of jobs that have not ended; small ones are in the database
  std::int64_t database = 0;    ///< with its log, its index and the reserve for a full disk
  std::int64_t quarantine = 0;  ///< counted at the start and with each removal of what has expired
  std::int64_t limit = 0;       ///< of all of them together; 0: none
  std::int64_t mesh_limit = 0;  ///< of the meshes; 0: none
  std::int64_t total() const { return meshes + results + requests + database + quarantine; }
};

/// Meshes, jobs, their requests and their results, beyond the life of a process.
///
/// Bytes are counted as they come and go. What would go beyond the quota expires the oldest results first, and throws
/// ProblemError "store.quota" where that does not make enough room. So it is with what one owner may hold: its own
/// oldest results go, and "store.key_quota" says that they do not suffice.
///
/// Content is compared with its hash whenever it is read: "store.corrupted" names a file that has changed. Every member
/// throws Error "store.full" where the disk is, "store.unavailable" where it or the database refuses otherwise. Any
/// thread may call; calls take turns.
class Store {
 public:
  Store() = default;
  virtual ~Store() = default;
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  using DescribeMesh = std::function<std::string(const std::string& id, std::int64_t created)>;
  /// The id is the hash of `ply`. Makes the description with `describe` and returns the record, and whether it is new;
  /// a mesh that is stored already stays as it is. `owner`, where it is named, becomes one of the mesh's owners in the
  /// same transaction, and new is what it did not own before.
  virtual std::pair<MeshRecord, bool> add_mesh(const std::string& ply, const DescribeMesh& describe,
                                               const std::string& owner = {}) = 0;
  virtual std::optional<MeshRecord> mesh(const std::string& id) const = 0;
  /// The newest first, of an owner alone where one is named; `after` is the last id of the page before.
  virtual std::vector<MeshRecord> meshes(std::size_t limit, const std::string& after,
                                         const std::string& owner = {}) const = 0;
  /// Canonical PLY. Throws "mesh.not_found", "store.corrupted", and what a requested stop does.
  virtual std::string mesh_content(const std::string& id, const CancellationToken& cancellation = {}) const = 0;
  /// The same, open, to be read in pieces: it takes a mebibyte of memory however large it is.
  virtual OpenContent open_mesh_content(const std::string& id, const CancellationToken& cancellation = {}) const = 0;
  /// False where there was none. Of an owner that is named the mesh is one no longer, and it goes with its last one.
  virtual bool remove_mesh(const std::string& id, const std::string& owner = {}) = 0;
  virtual bool owns_mesh(const std::string& id, const std::string& owner) const = 0;
  /// Whether removing it for the owner would remove the mesh itself.
  virtual bool is_last_owner_of_mesh(const std::string& id, const std::string& owner) const = 0;
  /// Says that a mesh is used now. It costs a microsecond; the database hears of it with the next removal of unused
  /// meshes.
  virtual void use_mesh(const std::string& id) const = 0;
  /// Removes the meshes that nobody has used since `before`, in milliseconds since 1970, and that no unfinished job
  /// works on. Returns their ids.
  virtual std::vector<std::string> remove_unused_meshes(std::int64_t before) = 0;

  /// Keeps what a job is made again from in a later process: in a file, durably once this returns, where it is large;
  /// otherwise the database takes it together with the job, for which it is returned, and a spare file has it for the
  /// case that the database is lost. One whose job is not added is dropped.
  virtual std::string keep_request(const JobRecord& job, const JobRequest& request, std::string_view body) = 0;
  virtual void drop_request(const std::string& id) = 0;
  virtual bool has_request(const std::string& id) const = 0;
  /// Throws "store.corrupted".
  virtual StoredRequest job_request(const std::string& id) const = 0;

  /// Durable once this returns, together with whose it is. `request` is what keep_request has returned. False, and
  /// nothing is added, where there is a job with the same key of idempotency.
  virtual bool add_job(const JobRecord& job, const std::string& request = {}) = 0;
  /// Notes an unfinished job's state, its start and its attempts. Outlives the process, but not necessarily the
  /// machine: nothing waits for the disk. Does nothing for a job that has finished. In a shared store it takes the job
  /// from all servers where it is to wait. False where another server has the job now, or has ended it.
  virtual bool note_progress(const JobRecord& job) = 0;
  /// Commits a job's end, with its result if it has one. Durable once this returns; its request is gone then. False,
  /// and nothing changes, where the job is not there any more, or another server has it.
  virtual bool finish_job(const JobRecord& job, const Result* result) = 0;
  virtual std::optional<JobRecord> job(const std::string& id) const = 0;
  /// Those in one of the states, or all where there is none, of an owner alone where one is named, the newest first;
  /// `after` is the last id of the page before.
  virtual std::vector<JobRecord> jobs(const std::vector<JobState>& states, std::size_t limit, const std::string& after,
                                      const std::string& owner = {}) const = 0;
  /// The job that was asked for with this key of idempotency.
  virtual std::optional<JobRecord> job_of_key(const std::string& key) const = 0;
  virtual bool owns_job(const std::string& id, const std::string& owner) const = 0;
  /// Its body has been compared with its hash, in a mebibyte of memory however large it is, and is open. Throws
  /// "job.not_found", "store.corrupted".
  virtual StoredResult job_result(const std::string& id) const = 0;
  virtual bool remove_job(const std::string& id) = 0;
  /// Jobs that an earlier process left unfinished, the oldest first; in a shared store none, for others may run them.
  virtual std::vector<JobRecord> unfinished_jobs() const = 0;
  /// Removes finished jobs that have expired by `now`, and the oldest finished ones beyond `most`. Returns their
  /// number.
  virtual std::size_t remove_expired_jobs(std::int64_t now, std::size_t most) = 0;

  /// Whether several servers use it. What follows does something only there: each job is held by one server, which has
  /// to be heard of every few seconds.
  virtual bool is_shared() const { return false; }
  /// Says that this server is alive and how far its jobs are, and when meshes were used. Returns the jobs that it
  /// holds.
  virtual std::vector<HeldJob> keep_holds(const std::vector<JobProgress>& /*running*/) { return {}; }
  /// Takes jobs from servers that have not been heard of, then jobs that wait at other servers, the oldest first.
  virtual std::vector<JobRecord> take_jobs(std::size_t /*most*/) { return {}; }
  /// How far a job is that another server runs.
  virtual std::optional<JobProgress> job_progress(const std::string& /*id*/) const { return std::nullopt; }
  /// Ends an unfinished job, whichever server holds it, as dismissed. Nothing where there is none.
  virtual std::optional<JobRecord> dismiss_job(const std::string& /*id*/, std::int64_t /*finished*/,
                                               std::int64_t /*expires*/) {
    return std::nullopt;
  }
  virtual bool has_unfinished_job_on(const std::string& /*mesh*/) const { return false; }
  /// False where another server has removed the mesh, which may take a second to be seen.
  virtual bool still_has_mesh(const std::string& /*id*/) const { return true; }

  /// Takes the reserve again that was given back on a full disk, once there is space; a microsecond where it is there.
  virtual void take_reserve() = 0;

  /// Takes a few microseconds.
  virtual Usage usage() const = 0;
};

}  // namespace supple::store
