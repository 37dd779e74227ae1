#pragma once

#include "supple/base/helper_processes.h"

namespace supple::meshing {

/// The tasks that a helper process does for this room: it fills surfaces with tetrahedra.
HelperTasks helper_tasks();

}  // namespace supple::meshing
