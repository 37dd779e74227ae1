#pragma once

#include <string>

#include "supple/http/message.h"
#include "supple/routes/services.h"

namespace supple::routes {

/// Whose things a request may see: the id of its key, or nothing where it may see those of all.
inline const std::string& owner_filter(const http::Request& request) {
  static const std::string all;
  return request.is_admin ? all : request.key;
}

/// Throws "mesh.not_found", with a pointer where one is given, as for a mesh that does not exist, where the request may
/// not see it. Without a filter it does not ask the store.
void require_mesh(const Services& services, const http::Request& request, const std::string& id,
                  const std::string& pointer = {});
/// Throws "job.not_found" likewise.
void require_job(const Services& services, const http::Request& request, const std::string& id);

}  // namespace supple::routes
