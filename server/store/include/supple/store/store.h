#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "supple/store/clock.h"
#include "supple/store/records.h"

namespace supple::store {

/// SHA-256 in hexadecimal.
std::string sha256(std::string_view bytes);

/// Meshes, jobs and results in one folder: an SQLite database (write-ahead log) for what is searched, one file for each
/// mesh and each result.
///
/// A file is written beside its place, synchronized, and renamed; its row is committed afterwards. So a row's file is
/// always complete, whenever the process or the machine stops.
///
/// At the start the database is looked through. A damaged one is moved into the folder "quarantine" and a new one is
/// made. Mesh files without a row whose name is their hash get a row again; every other file that no row knows is moved
/// into quarantine. Removed is only what was never acknowledged: half-written files, and the result of an unfinished
/// job.
///
/// Content is compared with its hash whenever it is read: "store.corrupted" names a file that has changed. Every member
/// throws Error "store.full" where the disk is, "store.unavailable" where it or the database refuses otherwise. Any
/// thread may call; calls take turns.
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
  explicit Store(const std::filesystem::path& folder, const Recovery& recovery = {});
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  using DescribeMesh = std::function<std::string(const std::string& id, std::int64_t created)>;
  /// The id is the hash of `ply`. Makes the description with `describe` and returns the record, and whether it is new;
  /// a mesh that is stored already stays as it is. `owner`, where it is named, becomes one of the mesh's owners, and
  /// new is what it did not own before.
  std::pair<MeshRecord, bool> add_mesh(const std::string& ply, const DescribeMesh& describe,
                                       const std::string& owner = {});
  std::optional<MeshRecord> mesh(const std::string& id) const;
  /// The newest first, of an owner alone where one is named; `after` is the last id of the page before.
  std::vector<MeshRecord> meshes(std::size_t limit, const std::string& after, const std::string& owner = {}) const;
  /// Canonical PLY. Throws "mesh.not_found", "store.corrupted".
  std::string mesh_content(const std::string& id) const;
  /// False where there was none. Of an owner that is named the mesh is one no longer, and it goes with its last one.
  bool remove_mesh(const std::string& id, const std::string& owner = {});
  bool owns_mesh(const std::string& id, const std::string& owner) const;
  /// Whether removing it for the owner would remove the mesh itself.
  bool is_last_owner_of_mesh(const std::string& id, const std::string& owner) const;

  void add_job(const JobRecord& job);
  /// Commits a job's end, with its result if it has one. Durable once this returns.
  void finish_job(const JobRecord& job, const Result* result);
  std::optional<JobRecord> job(const std::string& id) const;
  /// The newest first, of an owner alone where one is named.
  std::vector<JobRecord> jobs(std::optional<JobState> state, std::size_t limit, const std::string& after,
                              const std::string& owner = {}) const;
  /// Makes `owner` the owner of a job that exists.
  void own_job(const std::string& id, const std::string& owner);
  bool owns_job(const std::string& id, const std::string& owner) const;
  /// Throws "job.not_found", "store.corrupted".
  Result job_result(const std::string& id) const;
  bool remove_job(const std::string& id);
  /// Jobs that an earlier process left unfinished.
  std::vector<JobRecord> unfinished_jobs() const;
  /// Removes finished jobs that have expired by `now`, and the oldest finished ones beyond `most`. Returns their
  /// number.
  std::size_t remove_expired_jobs(std::int64_t now, std::size_t most);

 private:
  std::pair<MeshRecord, bool> add_content(const std::string& ply, const DescribeMesh& describe);

  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace supple::store
