#pragma once

#include "supple/base/helper_processes.h"

namespace supple::tiling {

/// What a helper process does for this room: meshes of structures, and their files.
HelperTasks helper_tasks();

}  // namespace supple::tiling
