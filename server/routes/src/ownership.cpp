#include "ownership.h"

#include "supple/store/store_error.h"

namespace supple::routes {

void require_mesh(const Services& services, const http::Request& request, const std::string& id) {
  const auto& owner = owner_filter(request);
  if (!owner.empty() && !services.store->meshes().owns_mesh(id, owner)) throw store::MeshNotFound(id);
}

void require_job(const Services& services, const http::Request& request, const std::string& id) {
  const auto& owner = owner_filter(request);
  if (!owner.empty() && !services.store->jobs().owns_job(id, owner)) throw store::JobNotFound(id);
}

}  // namespace supple::routes
