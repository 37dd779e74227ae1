#pragma once

#include <vector>

#include "request_pointers.h"
#include "supple/json/structure_requests.h"
#include "supple/tiling/structure.h"

namespace supple::routes {

/// The structure that a request means. Throws "tiling.*" with pointers for the paths "family" and "parameters".
tiling::Structure make_structure(const json::StructureSpec& spec, const PointerMap& pointers);

/// The structure of every family at its default parameters, in the families' order. Made once.
const std::vector<tiling::Structure>& preset_structures();

}  // namespace supple::routes
