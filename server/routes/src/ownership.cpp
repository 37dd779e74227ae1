#include "ownership.h"

#include <utility>
#include <vector>

#include "supple/store/store_error.h"

namespace supple::routes {

void require_mesh(const Services& services, const http::Request& request, const std::string& id,
                  const std::string& pointer) {
  const auto& owner = owner_filter(request);
  if (owner.empty() || services.store->meshes().owns_mesh(id, owner)) return;
  std::vector<Error::Detail> details;
  if (!pointer.empty()) details.push_back({pointer, "There is no mesh " + id.substr(0, 80) + "."});
  throw store::MeshNotFound(id.substr(0, 80), std::move(details));
}

void require_job(const Services& services, const http::Request& request, const std::string& id) {
  const auto& owner = owner_filter(request);
  if (!owner.empty() && !services.store->jobs().owns_job(id, owner)) throw store::JobNotFound(id);
}

}  // namespace supple::routes
