#include "supple/store/local_store.h"

#include <exception>

#include "local_state.h"
#include "supple/store/store_error.h"

namespace supple::store {

struct LocalStore::Parts {
  Parts(const std::filesystem::path& folder, const Recovery& recovery, const Quota& quota)
      : state(folder, recovery, quota),
        meshes(make_local_meshes(state)),
        families(make_local_families(state)),
        jobs(make_local_jobs(state)),
        blobs(make_local_blobs(state)) {}

  LocalState state;
  const std::unique_ptr<MeshStore> meshes;
  const std::unique_ptr<FamilyStore> families;
  const std::unique_ptr<JobStore> jobs;
  const std::unique_ptr<BlobStore> blobs;
};

LocalStore::LocalStore(const std::filesystem::path& folder, const Recovery& recovery, const Quota& quota) try
    : parts_(std::make_unique<Parts>(folder, recovery, quota)) {
} catch (const std::filesystem::filesystem_error& error) {
  throw StoreUnavailable("The data folder " + folder.string() + " cannot be used: " + error.code().message() + ".");
}

LocalStore::~LocalStore() {
  try {
    parts_->state.write_mesh_uses();
  } catch (const std::exception&) {
    // The times of use are lost, and these meshes may expire too early.
  }
}

MeshStore& LocalStore::meshes() const { return *parts_->meshes; }
FamilyStore& LocalStore::families() const { return *parts_->families; }
JobStore& LocalStore::jobs() const { return *parts_->jobs; }
BlobStore& LocalStore::blobs() const { return *parts_->blobs; }

void LocalStore::refill_reserve() {
  const std::lock_guard lock(parts_->state.mutex);
  parts_->state.reserve.refill();
}

Usage LocalStore::usage() const { return parts_->state.usage_counter.usage(); }

}  // namespace supple::store
