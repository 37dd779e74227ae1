#pragma once

#include <algorithm>
#include <chrono>
#include <functional>

#include "supple/http/message.h"
#include "supple/jobs/job_queue.h"
#include "supple/routes/services.h"

namespace supple::routes {

/// Computes as JobQueue::run_now does, for the client of the request: the computation is stopped once that has hung up,
/// and the client is answered at its deadline, whether it stops or not. One in the background owns what it uses, since
/// it may go on after this has returned, and its request leaves its slot to others (http::StandIn).
store::Result compute_now(const Services& services, const http::Request& request, const jobs::Computation& computation,
                          jobs::Profile* profile = nullptr);

/// To be called before the thread of a request waits for a computation of this priority: leaves its slot to others
/// where that is in the background. Throws as http::StandIn::wait_in_background does.
void leave_slot(const http::Request& request, Priority priority);

/// The same as compute_now for work without a result, on this thread whatever its priority: in the background it would
/// not be urgent enough for a client that waits. The computation says what it belongs to, and its client is that of the
/// request.
void work_now(const Services& services, const http::Request& request, jobs::Computation computation,
              const std::function<void(const Execution&)>& work);

/// Answers a computation with 200, whatever the request prefers. `reading_seconds` is what its preparation took.
http::Response answer_immediately(Services& services, const http::Request& request,
                                  const jobs::Computation& computation, double reading_seconds);

/// The response that has a result.
http::Response response_of(store::Result result);

inline double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// What is left at least of a deadline in seconds that counts from `begin`: one that has passed is told so.
inline double remaining_seconds(double deadline, std::chrono::steady_clock::time_point begin) {
  constexpr double min_seconds = 1e-3;
  return std::max(min_seconds, deadline - seconds_since(begin));
}

}  // namespace supple::routes
