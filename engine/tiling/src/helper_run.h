#pragma once

#include <string>
#include <string_view>

#include "supple/base/helper_processes.h"
#include "supple/tiling/tiling_error.h"

namespace supple::tiling {

/// Runs a task of this room in a helper process. An error of a task arrives as an Error, whatever its type was, and
/// gets its type back by its code.
inline std::string run_task(HelperProcesses& helpers, std::string_view task, std::string_view request,
                            const Execution& execution) {
  try {
    return helpers.run(task, request, execution);
  } catch (const Error& error) {
    if (error.code().starts_with("tiling.")) throw_typed(error);
    throw;
  }
}

}  // namespace supple::tiling
