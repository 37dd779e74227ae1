#pragma once

#include "supple/base/helper_processes.h"

namespace supple::numerics {

/// What a helper process does for this room: the ordering of large sparse matrices.
HelperTasks helper_tasks();

}  // namespace supple::numerics
