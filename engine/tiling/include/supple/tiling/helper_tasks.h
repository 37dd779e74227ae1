#pragma once

#include "supple/base/helper_processes.h"

namespace supple::tiling {

/// The tasks that a helper process does for this room: it makes meshes of structures, and their files.
HelperTasks helper_tasks();

}  // namespace supple::tiling
