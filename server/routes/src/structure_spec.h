#pragma once

#include "loader.h"
#include "request_pointers.h"
#include "supple/json/structure_requests.h"
#include "supple/tiling/structure.h"

namespace supple::routes {

/// The structure that a request means. Throws "tiling.*" with pointers for the paths "family" and "parameters".
tiling::Structure make_structure(const json::StructureSpec& spec, const Loader& loader, const PointerMap& pointers);

}  // namespace supple::routes
