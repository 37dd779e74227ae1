#pragma once

#include "supple/base/helper_processes.h"
#include "supple/tiling/part.h"

namespace supple::tiling {

/// What helper processes do about parts.
void add_part_tasks(HelperTasks& tasks);

/// `make_part` in this process, whatever helpers it has.
Part make_part_here(const PartDesign& design);

}  // namespace supple::tiling
