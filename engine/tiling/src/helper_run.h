#pragma once

#include <string>
#include <string_view>

#include "supple/base/helper_processes.h"
#include "supple/tiling/tiling_error.h"

namespace supple::tiling {

/// Runs a task of this room in a helper process. An error of a task arrives with its code alone; it gets back its type.
inline std::string run_task(HelperProcesses& helpers, std::string_view task, std::string_view request,
                            const Execution& execution) {
  try {
    return helpers.run(task, request, execution);
  } catch (const Error& error) {
    const std::string& code = error.code();
    if (code == "tiling.mesh_too_large") throw MeshTooLarge(code, error.what(), error.details());
    if (code == "tiling.mesh_option") throw MeshOptionError(code, error.what(), error.details());
    if (code == "tiling.part") throw PartError(code, error.what(), error.details());
    if (code.starts_with("tiling.")) throw TilingError(code, error.what(), error.details());
    throw;
  }
}

}  // namespace supple::tiling
