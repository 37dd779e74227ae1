#pragma once

#include "supple/base/helper_processes.h"

namespace supple::meshing {

/// What a helper process does for this room: tetrahedra that fill surfaces.
HelperTasks helper_tasks();

}  // namespace supple::meshing
