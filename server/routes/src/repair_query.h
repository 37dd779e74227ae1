#pragma once

#include <optional>

#include "supple/http/message.h"
#include "supple/surface/mesh_repair.h"

namespace supple::routes {

/// Reads the query parameters `repair` and `weld_tolerance` of an upload; nullopt if there are none. Throws
/// "request.invalid_parameter", which names each parameter at fault, also those that do not exist.
std::optional<surface::RepairOptions> read_repair_query(const http::Request& request);

}  // namespace supple::routes
