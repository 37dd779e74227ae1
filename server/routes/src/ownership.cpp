#include "ownership.h"

#include <algorithm>

#include "supple/store/store_error.h"
#include "supple/tiling/tiling_error.h"

namespace supple::routes {

void require_mesh(const Services& services, const http::Request& request, const std::string& id) {
  const auto& owner = owner_filter(request);
  if (!owner.empty() && !services.store->meshes().owns_mesh(id, owner)) throw store::MeshNotFound(id);
}

void require_job(const Services& services, const http::Request& request, const std::string& id) {
  const auto& owner = owner_filter(request);
  if (!owner.empty() && !services.store->jobs().owns_job(id, owner)) throw store::JobNotFound(id);
}

std::shared_ptr<const tiling::Family> published_family(const Services& services, const std::string& owner,
                                                       const std::string& name) {
  for (const auto& model : services.models->models(owner))
    if (model->model.family == name && !model->model.definition.empty()) return model->family;
  return nullptr;
}

void throw_family_not_found(const Services& services, const std::string& owner, const std::string& name) {
  constexpr std::size_t max_listed = 20;  // of the owner's; GET /v1/families lists all
  std::string known;
  for (const auto& family : tiling::families()) known += (known.empty() ? "" : ", ") + family.id;
  const auto added = services.store->families().families(owner);
  for (std::size_t i = 0; i < std::min(added.size(), max_listed); ++i) known += ", " + added[i].name;
  if (added.size() > max_listed) known += " and " + std::to_string(added.size() - max_listed) + " more";
  // The name is the client's, and may be of any length.
  throw tiling::FamilyNotFound("tiling.family_not_found",
                               "There is no family \"" + name.substr(0, 80) + "\"; known are " + known + ".",
                               {{"family", "must be one of " + known}});
}

}  // namespace supple::routes
