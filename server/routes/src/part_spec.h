#pragma once

#include <string>

#include "loader.h"
#include "request_pointers.h"
#include "supple/base/execution.h"
#include "supple/json/part_requests.h"
#include "supple/tiling/part.h"

// Parts of requests. `base` is the place of the part's fields in the request: "" or "/part".
namespace supple::routes {

/// The design of the part that a request means. Throws "tiling.*" with pointers.
tiling::PartDesign part_design(const json::PartRequest& request, const Loader& loader, const std::string& base);

/// Where the fields of a part's design are in the request.
PointerMap part_pointers(const std::string& base);

/// Makes the part, as the beginning of a computation, and bills the stage "part" and its effects. Throws what
/// tiling::make_part throws, with pointers.
tiling::Part make_part_billed(const tiling::PartDesign& design, const std::string& base, const Execution& execution);

}  // namespace supple::routes
