#include "supple/store/shared_store.h"

#include "shared_state.h"
#include "supple/store/store_error.h"

namespace supple::store {

struct SharedStore::Parts {
  explicit Parts(const Options& options)
      : state(options),
        meshes(make_shared_meshes(state)),
        families(make_shared_families(state)),
        jobs(make_shared_jobs(state)),
        blobs(make_shared_blobs(state)),
        leases(make_shared_leases(state)) {}

  SharedState state;
  const std::unique_ptr<MeshStore> meshes;
  const std::unique_ptr<FamilyStore> families;
  const std::unique_ptr<JobStore> jobs;
  const std::unique_ptr<BlobStore> blobs;
  const std::unique_ptr<LeaseStore> leases;
};

SharedStore::SharedStore(const Options& options) try : parts_(std::make_unique<Parts>(options)) {
} catch (const std::filesystem::filesystem_error& error) {
  throw StoreUnavailable("The data folder " + options.folder.string() + " cannot be used: " + error.code().message() +
                         ".");
}

SharedStore::~SharedStore() { parts_->state.end_leases(); }

MeshStore& SharedStore::meshes() const { return *parts_->meshes; }
FamilyStore& SharedStore::families() const { return *parts_->families; }
JobStore& SharedStore::jobs() const { return *parts_->jobs; }
BlobStore& SharedStore::blobs() const { return *parts_->blobs; }
LeaseStore* SharedStore::leases() const { return parts_->leases.get(); }

Usage SharedStore::usage() const { return parts_->state.usage_now(); }

}  // namespace supple::store
