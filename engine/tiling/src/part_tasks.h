#pragma once

#include "supple/base/helper_processes.h"

namespace supple::tiling {

/// What helper processes do about parts.
void add_part_tasks(HelperTasks& tasks);

}  // namespace supple::tiling
