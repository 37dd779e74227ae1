#include "supple/store/store_error.h"

#include <utility>

namespace supple::store {

StoreFull::StoreFull(const std::string& message) : Error("store.full", message) {}

StoreUnavailable::StoreUnavailable(const std::string& message) : Error("store.unavailable", message) {}

StoreCorrupted::StoreCorrupted(const std::string& message) : Error("store.corrupted", message) {}

MeshNotFound::MeshNotFound(const std::string& id, std::vector<Detail> details)
    : Error("mesh.not_found", "There is no mesh " + id + ".", std::move(details)) {}

JobNotFound::JobNotFound(const std::string& id) : Error("job.not_found", "There is no job " + id + ".") {}

ModelNotFound::ModelNotFound(const std::string& id, const std::string& known)
    : Error("model.not_found", "There is no model " + id + "; " + known) {}

}  // namespace supple::store
