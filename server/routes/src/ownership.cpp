#include "ownership.h"

#include <vector>

#include "supple/base/error.h"

namespace supple::routes {

void require_mesh(const Services& services, const http::Request& request, const std::string& id,
                  const std::string& pointer) {
  const auto& owner = owner_filter(request);
  if (owner.empty() || services.store->meshes().owns_mesh(id, owner)) return;
  const auto text = "There is no mesh " + id.substr(0, 80) + ".";
  std::vector<Error::Detail> details;
  if (!pointer.empty()) details.push_back({pointer, text});
  throw Error("mesh.not_found", text, details);
}

void require_job(const Services& services, const http::Request& request, const std::string& id) {
  const auto& owner = owner_filter(request);
  if (!owner.empty() && !services.store->jobs().owns_job(id, owner))
    throw Error("job.not_found", "There is no job " + id + ".");
}

}  // namespace supple::routes
