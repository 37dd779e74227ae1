#pragma once

#include <string>
#include <vector>

#include "supple/base/error.h"
#include "supple/json/structure_requests.h"
#include "supple/tiling/structure.h"

namespace supple::routes {

/// The structure that a request means. Throws "tiling.*" with pointers into the request.
tiling::Structure make_structure(const json::StructureSpec& spec);

/// The error with every place in `folder`.
Error moved(const Error& error, const std::string& folder);

/// Calls mesh() and moves what it says about mesh options to their place in the request: "mesh_size" becomes `folder`
/// followed by it.
template <class Mesh>
auto with_mesh_pointers(const std::string& folder, Mesh mesh) {
  try {
    return mesh();
  } catch (const Error& error) {
    if (error.code() != "tiling.mesh_option" && error.code() != "tiling.mesh_too_large") throw;
    throw moved(error, folder);
  }
}

/// The structure of every family at its default parameters, in the families' order. Made once.
const std::vector<tiling::Structure>& preset_structures();

}  // namespace supple::routes
