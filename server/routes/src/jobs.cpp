#include <optional>

#include "handlers.h"
#include "job_events.h"
#include "ownership.h"
#include "supple/routes/guard.h"

namespace supple::routes {
namespace {

using store::JobState;

/// The id of the job that the path names. Throws "job.not_found" if the request may not see it.
const std::string& job_parameter(const Services& services, const http::Request& request) {
  const auto& id = request.path_parameters.at("job");
  require_job(services, request, id);
  return id;
}

http::Response list(Services& services, const http::Request& request) {
  require_ready(services);
  const auto page = read_page(request, {"state"});
  std::optional<JobState> state;
  if (const auto given = request.query.find("state"); given != request.query.end()) {
    state = store::state_of(given->second);
    if (!state) {
      throw Error("request.invalid_parameter",
                  "The query parameter state takes accepted, running, successful, failed or dismissed.");
    }
  }
  return page_response("jobs", services.jobs->list(state, page.limit + 1, page.after, owner_filter(request)), page,
                       write_job, [](const auto& status) { return status.record.id; });
}

http::Response show_job(Services& services, const http::Request& request) {
  require_ready(services);
  const auto status = services.jobs->status(job_parameter(services, request));
  auto response = json_response(write_job(status));
  if (!is_finished(status)) response.set_header("Retry-After", "1");
  return response;
}

http::Response result(Services& services, const http::Request& request) {
  require_ready(services);
  const auto& id = job_parameter(services, request);
  http::Response response;
  if (const auto status = services.jobs->status(id); status.record.state == JobState::failed) {
    response.status = status.record.error_status;
    response.content_type = "application/problem+json";
    response.body = status.record.error;
    return response;
  }
  auto stored = services.jobs->result(id);
  response.content_type = std::move(stored.content_type);
  response.headers = std::move(stored.headers);
  response.piecewise_body = body_of(std::move(stored.body));
  return response;
}

http::Response remove_job(Services& services, const http::Request& request) {
  require_ready(services);
  if (const auto dismissed = services.jobs->remove(job_parameter(services, request)))
    return json_response(write_job(*dismissed));
  http::Response response;
  response.status = 204;
  return response;
}

/// One of the event streams that are followed at the same time. Throws "server.too_many_event_streams" if there are
/// enough.
class StreamPlace {
 public:
  explicit StreamPlace(Services& services) : services_(services) {
    const int limit = services.limits.event_streams;
    if (++services.event_streams <= limit) return;
    const int value = services.event_streams--;
    problem::Problem problem{
        "server.too_many_event_streams",
        "The server sends " + std::to_string(limit) + " event streams, its limit (setting --event-streams).",
        {},
        problem::Limit{static_cast<double>(limit), static_cast<double>(value), "--event-streams"},
        1};
    throw problem::ProblemError(std::move(problem));
  }
  ~StreamPlace() { --services_.event_streams; }
  StreamPlace(const StreamPlace&) = delete;
  StreamPlace& operator=(const StreamPlace&) = delete;

 private:
  Services& services_;
};

http::Response events(Services& services, const http::Request& request) {
  require_ready(services);
  const auto& id = job_parameter(services, request);
  services.jobs->status(id);
  auto place = std::make_shared<StreamPlace>(services);
  http::Response response;
  response.content_type = "text/event-stream";
  response.set_header("Cache-Control", "no-store");
  const auto may_follow = [&services, authorization = std::string(request.header("Authorization")),
                           session = session_of(request)] {
    return !services.gate || services.gate->still_valid({authorization, session});
  };
  response.stream = [&services, id, may_follow, place](http::StreamWriter& out) {
    follow_job({.wait_for_change = [&](std::uint64_t& version,
                                       double seconds) { return services.jobs->wait_for_change(id, version, seconds); },
                .may_follow = [&] { return !services.stopping && may_follow(); }},
               out);
  };
  return response;
}

}  // namespace

void add_job_routes(http::Router& router, Services& services) {
  router.add({"GET", "/v1/jobs", handler_with<Services>(services, list), {}});
  router.add({"GET", "/v1/jobs/{job}", handler_with(services, show_job), {}});
  router.add({"DELETE", "/v1/jobs/{job}", handler_with(services, remove_job), {}});
  router.add({"GET", "/v1/jobs/{job}/result", handler_with(services, result), {}});
  router.add({"GET", "/v1/jobs/{job}/events", handler_with(services, events), {}});
}

}  // namespace supple::routes
