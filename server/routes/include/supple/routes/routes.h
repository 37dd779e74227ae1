#pragma once

#include "supple/http/router.h"
#include "supple/routes/services.h"

namespace supple::routes {

/// Every endpoint of api/openapi.yaml, and the files of `services.web`. `services` outlives the router. Throws
/// std::runtime_error where those files cannot be read.
http::Router make_router(Services& services);

/// The response for a problem: application/problem+json, Retry-After where the problem has it.
http::Response problem_response(const problem::Problem& problem);

}  // namespace supple::routes
