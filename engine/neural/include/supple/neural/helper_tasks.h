#pragma once

#include "supple/base/helper_processes.h"

namespace supple::neural {

/// What a helper process does for this room: it reads the files of models.
HelperTasks helper_tasks();

}  // namespace supple::neural
