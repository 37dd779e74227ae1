#pragma once

#include "supple/http/router.h"
#include "supple/jobs/job_queue.h"

namespace supple::routes {

/// The computation of a stored job, prepared by the endpoint of its request as when the request came. Throws what the
/// client would have been told, "job.interrupted" if this version has no such endpoint, and the error of a stop
/// request.
jobs::Computation computation_of(const http::Router& router, const store::JobRecord& job, store::StoredRequest stored,
                                 const Execution& execution);

}  // namespace supple::routes
