#pragma once

#include "supple/base/helper_processes.h"

namespace supple::neural {

/// The tasks of helper processes for this room: one reads the files of models.
HelperTasks helper_tasks();

}  // namespace supple::neural
