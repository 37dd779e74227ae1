#pragma once

#include "supple/http/router.h"
#include "supple/jobs/job_queue.h"

namespace supple::routes {

/// The computation that the request of a stored job asks for, made by its route as when the request came: parsed,
/// checked, with the mesh and the models that it names. Throws what the client would have been told, "job.interrupted"
/// where the route makes no computation of it any more, and what a stop of `execution` does.
jobs::Computation computation_of(const http::Router& router, const store::JobRecord& job, store::StoredRequest stored,
                                 const Execution& execution);

}  // namespace supple::routes
