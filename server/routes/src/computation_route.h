#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "supple/http/message.h"
#include "supple/jobs/job_queue.h"
#include "supple/json/answers.h"
#include "supple/neural/model.h"
#include "supple/routes/services.h"

namespace supple::routes {

/// Answers a computation as the request's Prefer header asks for: immediately, or with 202 and a job.
http::Response answer_computation(Services& services, const http::Request& request, jobs::Computation computation);

/// Whether the request prefers a job to an immediate answer.
inline bool becomes_job(const http::Request& request) { return !request.header("Prefer").empty(); }

/// Answers a computation with 200, whatever the request prefers.
http::Response answer_immediately(Services& services, const http::Request& request,
                                  const jobs::Computation& computation);

/// Computes on this thread, as JobQueue::run_now does, for the client of the request: the computation is stopped once
/// that has hung up, and the client is answered at its deadline, whether it stops or not.
store::Result compute_now(const Services& services, const http::Request& request, const jobs::Computation& computation,
                          jobs::Profile* profile = nullptr);

/// The mesh of a computation with a deadline in seconds. One that is not in memory is loaded within a compute slot and
/// the deadline, and for as long as the client is there. Throws "mesh.not_found" with a pointer to the field, also
/// where the request may not see it, and what ends a computation.
std::shared_ptr<const store::LoadedMesh> load_mesh(const Services& services, const http::Request& request,
                                                   const std::string& id, double deadline);

/// The search for nearest points of a mesh. Where it is not made yet, that of a large mesh is made as a mesh is loaded:
/// within a compute slot and the deadline, and for as long as the client is there. Throws what ends a computation.
const surface::NearestPointSearch& nearest_search(const Services& services, const http::Request& request,
                                                  const std::string& id, const store::LoadedMesh& mesh,
                                                  double deadline);

/// The body as text that must be JSON. Throws "http.unsupported_media_type" for another Content-Type.
const std::string& json_body(const http::Request& request);

/// Calls compute(execution) with a cost ledger and returns what it cost.
template <class Compute>
json::Bill billed(const Execution& outer, Compute compute) {
  json::Bill bill;
  Execution execution = outer;
  execution.cost = &bill.ledger;
  const auto start = std::chrono::steady_clock::now();
  compute(execution);
  bill.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return bill;
}

/// Tells of an optional part that the request alone decides on.
void tell_asked(const Execution& execution, std::string_view effect, bool asked);

/// Tells whether the answers of a model have error bars.
void tell_error_bars(const neural::Model& model, const Execution& execution);

/// The shortest text that reads back as the same number, for headers.
std::string plain_number(double value);

inline store::Result json_result(std::string body) { return {"application/json", {}, std::move(body)}; }

}  // namespace supple::routes
