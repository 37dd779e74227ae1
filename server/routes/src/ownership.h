#pragma once

#include <memory>
#include <string>

#include "supple/http/message.h"
#include "supple/routes/services.h"
#include "supple/tiling/family.h"

namespace supple::routes {

/// The owner whose meshes and jobs a request may see: the id of its key, or nothing if it may see those of all owners.
inline const std::string& owner_filter(const http::Request& request) {
  static const std::string all;
  return request.is_admin ? all : request.key;
}

/// Throws "mesh.not_found" if the request may not see the mesh: to its client the mesh does not exist. The store is not
/// asked for a request that may see everything.
void require_mesh(const Services& services, const http::Request& request, const std::string& id);
/// The same for a job, with "job.not_found".
void require_job(const Services& services, const http::Request& request, const std::string& id);

/// The family of this name that a model defines which the owner sees; null if there is none.
std::shared_ptr<const tiling::Family> published_family(const Services& services, const std::string& owner,
                                                       const std::string& name);

/// Throws "tiling.family_not_found", which lists the families that come with the server and those of an owner.
[[noreturn]] void throw_family_not_found(const Services& services, const std::string& owner, const std::string& name);

}  // namespace supple::routes
