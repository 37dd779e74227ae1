#pragma once

#include "supple/tiling/structure.h"

namespace supple::testing {

/// The structure with the default parameters.
inline tiling::Structure preset_structure(const char* id) { return tiling::make_structure(id); }

}  // namespace supple::testing
