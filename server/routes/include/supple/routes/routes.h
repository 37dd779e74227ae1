#pragma once

#include "supple/http/router.h"
#include "supple/routes/services.h"

namespace supple::routes {

/// Every endpoint of api/openapi.yaml, and the files of `services.web`. `services` outlives the router. Throws
/// std::runtime_error if those files cannot be read.
http::Router make_router(Services& services);

/// The response for a problem: application/problem+json, and Retry-After if the problem has it.
http::Response problem_response(const problem::Problem& problem);

}  // namespace supple::routes
