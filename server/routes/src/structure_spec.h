#pragma once

#include "supple/json/structure_requests.h"
#include "supple/tiling/structure.h"

namespace supple::routes {

/// The structure that a request means. Throws "tiling.*" with pointers into the request.
tiling::Structure make_structure(const json::StructureSpec& spec);

/// The structure of every family at its default parameters, in the families' order. Made once.
const std::vector<tiling::Structure>& preset_structures();

}  // namespace supple::routes
