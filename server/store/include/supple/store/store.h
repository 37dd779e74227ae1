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

/// Meshes, jobs, their requests and their results in one folder: an SQLite database (write-ahead log) for what is
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
/// Bytes are counted as files come and go. What would go beyond the quota expires the oldest results first, and throws
/// ProblemError "store.quota" where that does not make enough room. So it is with what one owner may hold: its own
/// oldest results go, and "store.key_quota" says that they do not suffice.
///
/// Content is compared with its hash whenever it is read: "store.corrupted" names a file that has changed. Every member
/// throws Error "store.full" where the disk is, "store.unavailable" where it or the database refuses otherwise;
/// removing works on a full disk too, in the place of a reserve that is held for that. Any thread may call; calls take
/// turns.
class Store {
 public:
  /// What the store needs in order to recover at the start.
  struct Recovery {
    /// Makes the description of a mesh anew from its file. Without it, or where it throws, the file goes into
    /// quarantine.
    std::function<std::string(const std::string& ply, const std::string& id, std::int64_t created)> describe;
    std::function<void(const std::string&)> warn;  ///< hears what was found and what became of it
  };

  /// Opens or makes the folder. Throws also where another process has it open.
  explicit Store(const std::filesystem::path& folder, const Recovery& recovery = {}, const Quota& quota = {});
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  using DescribeMesh = std::function<std::string(const std::string& id, std::int64_t created)>;
  /// The id is the hash of `ply`. Makes the description with `describe` and returns the record, and whether it is new;
  /// a mesh that is stored already stays as it is. `owner`, where it is named, becomes one of the mesh's owners in the
  /// same transaction, and new is what it did not own before.
  std::pair<MeshRecord, bool> add_mesh(const std::string& ply, const DescribeMesh& describe,
                                       const std::string& owner = {});
  std::optional<MeshRecord> mesh(const std::string& id) const;
  /// The newest first, of an owner alone where one is named; `after` is the last id of the page before.
  std::vector<MeshRecord> meshes(std::size_t limit, const std::string& after, const std::string& owner = {}) const;
  /// Canonical PLY. Throws "mesh.not_found", "store.corrupted", and what a requested stop does.
  std::string mesh_content(const std::string& id, const CancellationToken& cancellation = {}) const;
  /// The same, open, to be read in pieces: it takes a mebibyte of memory however large it is.
  OpenContent open_mesh_content(const std::string& id, const CancellationToken& cancellation = {}) const;
  /// False where there was none. Of an owner that is named the mesh is one no longer, and it goes with its last one.
  bool remove_mesh(const std::string& id, const std::string& owner = {});
  bool owns_mesh(const std::string& id, const std::string& owner) const;
  /// Whether removing it for the owner would remove the mesh itself.
  bool is_last_owner_of_mesh(const std::string& id, const std::string& owner) const;
  /// Says that a mesh is used now. It costs a microsecond; the database hears of it with the next removal of unused
  /// meshes.
  void use_mesh(const std::string& id) const;
  /// Removes the meshes that nobody has used since `before`, in milliseconds since 1970, and that no unfinished job
  /// works on. Returns their ids.
  std::vector<std::string> remove_unused_meshes(std::int64_t before);

  /// Keeps what a job is made again from in a later process: in a file, durably once this returns, where it is large;
  /// otherwise the database takes it together with the job, for which it is returned, and a spare file has it for the
  /// case that the database is lost. One whose job is not added is dropped.
  std::string keep_request(const JobRecord& job, const JobRequest& request, std::string_view body);
  void drop_request(const std::string& id);
  bool has_request(const std::string& id) const;
  /// Throws "store.corrupted".
  StoredRequest job_request(const std::string& id) const;

  /// Durable once this returns, together with whose it is. `request` is what keep_request has returned.
  void add_job(const JobRecord& job, const std::string& request = {});
  /// Notes an unfinished job's state, its start and its attempts. Outlives the process, but not necessarily the
  /// machine: nothing waits for the disk. Does nothing for a job that has finished.
  void note_progress(const JobRecord& job);
  /// Commits a job's end, with its result if it has one. Durable once this returns; its request is gone then.
  void finish_job(const JobRecord& job, const Result* result);
  std::optional<JobRecord> job(const std::string& id) const;
  /// Those in one of the states, or all where there is none, of an owner alone where one is named, the newest first;
  /// `after` is the last id of the page before.
  std::vector<JobRecord> jobs(const std::vector<JobState>& states, std::size_t limit, const std::string& after,
                              const std::string& owner = {}) const;
  bool owns_job(const std::string& id, const std::string& owner) const;
  /// Its body has been compared with its hash, in a mebibyte of memory however large it is, and is open. Throws
  /// "job.not_found", "store.corrupted".
  StoredResult job_result(const std::string& id) const;
  bool remove_job(const std::string& id);
  /// Jobs that an earlier process left unfinished, the oldest first.
  std::vector<JobRecord> unfinished_jobs() const;
  /// Removes finished jobs that have expired by `now`, and the oldest finished ones beyond `most`. Returns their
  /// number.
  std::size_t remove_expired_jobs(std::int64_t now, std::size_t most);

  /// Takes the reserve again that was given back on a full disk, once there is space; a microsecond where it is there.
  void take_reserve();

  /// Takes a few microseconds.
  Usage usage() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace supple::store
