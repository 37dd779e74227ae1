#pragma once

#include "supple/base/helper_processes.h"

namespace supple::numerics {

/// The task that this room gives to helper processes: the ordering of large sparse matrices.
HelperTasks helper_tasks();

}  // namespace supple::numerics
