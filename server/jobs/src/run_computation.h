#pragma once

#include "supple/budget/memory.h"
#include "supple/jobs/computation.h"

namespace supple::jobs {

/// Runs a computation on this thread and counts what it allocates, if there is a budget. Throws what it throws, or why
/// it was stopped: "request.too_much_memory", "server.out_of_memory".
store::Result run_computation(const Computation& computation, const Execution& execution, budget::MemoryBudget* memory,
                              Profile* profile = nullptr);

/// The answer outlives its computation, which paid for its memory. This makes the request pay for it instead.
store::Result charge_request(store::Result result);

}  // namespace supple::jobs
