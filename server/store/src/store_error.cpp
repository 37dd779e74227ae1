#include "supple/store/store_error.h"

namespace supple::store {

StoreFull::StoreFull(const std::string& message) : Error("store.full", message) {}

StoreUnavailable::StoreUnavailable(const std::string& message) : Error("store.unavailable", message) {}

StoreCorrupted::StoreCorrupted(const std::string& message) : Error("store.corrupted", message) {}

// The id is the client's, and may be of any length.
MeshNotFound::MeshNotFound(const std::string& id)
    : Error("mesh.not_found", "There is no mesh " + id.substr(0, 80) + ".") {}

JobNotFound::JobNotFound(const std::string& id) : Error("job.not_found", "There is no job " + id + ".") {}

ModelNotFound::ModelNotFound(const std::string& id, const std::string& known)
    : Error("model.not_found", "There is no model " + id + "; " + known) {}

}  // namespace supple::store
