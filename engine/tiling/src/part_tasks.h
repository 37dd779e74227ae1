#pragma once

#include "supple/base/helper_processes.h"
#include "supple/tiling/part.h"

namespace supple::tiling {

/// Adds the tasks that helper processes do for parts.
void add_part_tasks(HelperTasks& tasks);
/// Adds the task that meshes parts.
void add_part_mesh_task(HelperTasks& tasks);

/// Does the same as `make_part` in this process, even if there are helper processes.
Part make_part_here(const PartDesign& design);

}  // namespace supple::tiling
