#pragma once

#include "supple/base/helper_processes.h"

namespace supple::meshing {

/// The tasks that a helper process does for this room: it fills surfaces with tetrahedra.
HelperTasks helper_tasks();

/// Starts gmsh, which takes some milliseconds, so that children of this process need not start it. Meshes nothing and
/// starts no thread.
void prepare_helper();

}  // namespace supple::meshing
