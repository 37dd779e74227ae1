#include "endpoint.h"

#include <algorithm>
#include <utility>

#include "handlers.h"
#include "immediate_answer.h"
#include "job_events.h"
#include "results.h"
#include "supple/routes/resume.h"

namespace supple::routes {
namespace {

using Clock = std::chrono::steady_clock;

/// Bytes of a body up to which it is parsed outside of the compute slots. That takes a tenth of a second at most, as
/// 40 MB take 2 to 4 seconds; no request waits so long for others that compute.
constexpr std::size_t max_bytes_at_once = 1 << 20;

http::Response accepted(const jobs::JobStatus& status) {
  auto response = json_response(write_job(status), 202);
  response.set_header("Location", "/v1/jobs/" + status.record.id);
  response.set_header("Retry-After", "1");
  return response;
}

/// The media type of the answer. Throws "http.not_acceptable".
std::string_view negotiate_format(const Endpoint& endpoint, const http::Request& request) {
  const auto& formats = endpoint.formats;
  if (formats.size() == 1) return formats.front();
  if (const auto format = http::negotiate(request.header("Accept"), formats)) return *format;
  std::string list(formats.front());
  for (std::size_t i = 1; i < formats.size(); ++i)
    list.append(i + 1 < formats.size() ? ", " : " or ").append(formats[i]);
  throw Error("http.not_acceptable", endpoint.sends + " " + list + ".");
}

/// What makes two requests of the same client one job: its header Idempotency-Key and what it asks for.
void identify(jobs::Computation& computation, const Endpoint& endpoint, const http::Request& request,
              std::string_view format) {
  const auto key = request.header("Idempotency-Key");
  if (key.empty()) return;
  constexpr std::size_t max_length = 255;
  const auto is_plain = [](char c) { return c > ' ' && c <= '~'; };
  if (key.size() > max_length || !std::all_of(key.begin(), key.end(), is_plain)) {
    throw Error("request.invalid_parameter",
                "The header Idempotency-Key takes 1 to 255 printable ASCII characters without spaces.");
  }
  computation.idempotency_key = store::sha256(request.key + "\n" + key);
  std::string asked = request.method + " " + request.path + "\n";
  for (const auto& [name, value] : request.query) asked.append(name).append("=").append(value).append("\n");
  // The first format is left out, as it is in the hashes of earlier versions.
  if (format != endpoint.formats.front()) asked.append("Accept: ").append(format).append("\n");
  computation.request_hash = store::sha256(asked + store::sha256(request.body));
}

/// What a later process can make the job of this request from again.
jobs::RequestOfJob request_of_job(const http::Request& request) {
  return {{request.method, request.path, request.query, request.header("Content-Type"), request.header("Accept")},
          request.body};
}

EndpointRequest endpoint_request(const http::Request& request, std::string_view format, bool becomes_job) {
  return {
      .body = request.body, .path_parameters = request.path_parameters, .format = format, .becomes_job = becomes_job};
}

/// The handler of an endpoint's route. It is a class so that a route's endpoint can be found in its handler.
class EndpointHandler {
 public:
  /// `ready_answer` is that of a GET endpoint; empty for those that clients POST to.
  EndpointHandler(Services& services, Endpoint endpoint, ReadyAnswer ready_answer = {})
      : services_(services), endpoint_(std::move(endpoint)), ready_answer_(std::move(ready_answer)) {}

  /// Answers as the header Prefer asks for: immediately, or with 202 and a job.
  http::Response operator()(const http::Request& request) const {
    require_ready(services_);
    const auto begin = Clock::now();
    const auto format = negotiate_format(endpoint_, request);
    require_body(request);
    if (ready_answer_)
      if (auto answer = ready_answer_(request)) return std::move(*answer);
    const auto preference = http::parse_preference(request.header("Prefer"), services_.limits.max_wait);
    const bool becomes_job = endpoint_.is_long || preference.respond_async || preference.wait;
    auto computation = computation_of(request, prepare(request, endpoint_request(request, format, becomes_job), begin));
    if (!becomes_job) {
      // The deadline of an immediate answer counts from the request's arrival: reading a large body takes part of it.
      // The deadline of a job counts from its acceptance.
      computation.deadline = remaining_seconds(computation.deadline, begin);
      return answer_immediately(services_, request, computation, seconds_since(begin));
    }
    identify(computation, endpoint_, request, format);
    return answer_with_job(request, std::move(computation), preference);
  }

  /// The computation of a stored job, on a thread that computes.
  jobs::Computation repeat(const http::Request& request, const Execution& execution) const {
    require_body(request);
    const auto asked = endpoint_request(request, negotiate_format(endpoint_, request), true);
    return computation_of(request, prepare(asked, Loader(services_, request, execution)));
  }

 private:
  struct Prepared {
    PreparedComputation computation;
    std::string families;  ///< ids of the added families that it needs, as in store::JobRecord
  };

  void require_body(const http::Request& request) const {
    if (!ready_answer_) require_json(request);
  }

  Prepared prepare(const EndpointRequest& asked, const Loader& loader) const {
    auto computation = endpoint_.prepare(asked, loader);
    return {std::move(computation), loader.added_families()};
  }

  Prepared prepare(const http::Request& request, const EndpointRequest& asked, Clock::time_point begin) const {
    if (request.body.size() <= max_bytes_at_once) return prepare(asked, Loader(services_, request, begin));
    Prepared prepared;
    const double deadline = remaining_seconds(json::peek_deadline(request.body, services_.limits.json), begin);
    jobs::Computation reading{.kind = endpoint_.kind, .mesh = {}, .deadline = deadline, .run = {}};
    reading.priority = priority_of_preparation(request.body);
    work_now(services_, request, std::move(reading),
             [&](const Execution& execution) { prepared = prepare(asked, Loader(services_, request, execution)); });
    return prepared;
  }

  jobs::Computation computation_of(const http::Request& request, Prepared&& made) const {
    auto& [prepared, families] = made;
    // Who sends requests with a session, one after the other, waits for the latest one.
    const auto unasked = prepared.session.empty() ? Priority::normal : Priority::interactive;
    // Sessions of two keys that have the same name are two.
    if (!prepared.session.empty() && !request.key.empty()) prepared.session = request.key + " " + prepared.session;
    return {.kind = endpoint_.kind,
            .mesh = std::move(prepared.mesh),
            .deadline = prepared.deadline,
            .run = std::move(prepared.run),
            .session = std::move(prepared.session),
            .client = request.client,
            .owner = request.key,
            .bytes = static_cast<std::int64_t>(request.body.size()),
            .max_waiting = request.max_waiting_jobs,
            .priority = json::peek_priority(request.body).value_or(unasked),
            .families = std::move(families)};
  }

  http::Response answer_with_job(const http::Request& request, jobs::Computation computation,
                                 const http::Preference& preference) const {
    http::Response response;
    if (preference.wait && *preference.wait > 0) {
      const auto hung_up = [peer = request.peer] { return peer.hung_up(); };
      leave_slot(request, computation.priority);
      auto outcome =
          services_.jobs->run_within(std::move(computation), *preference.wait, hung_up, request_of_job(request));
      response = outcome.result ? response_of(std::move(*outcome.result)) : accepted(outcome.job);
      response.set_header("Preference-Applied", "wait=" + plain_number(*preference.wait));
    } else {
      response = accepted(services_.jobs->submit(std::move(computation), request_of_job(request)));
      response.set_header("Preference-Applied", preference.respond_async ? "respond-async" : "wait=0");
    }
    return response;
  }

  Services& services_;
  const Endpoint endpoint_;
  const ReadyAnswer ready_answer_;
};

}  // namespace

void add_endpoint(http::Router& router, Services& services, Endpoint endpoint) {
  auto path = endpoint.path.empty() ? "/v1/" + endpoint.kind : endpoint.path;
  router.add({"POST",
              std::move(path),
              EndpointHandler(services, std::move(endpoint)),
              {services.limits.max_json, "--max-json"}});
}

void add_get_endpoint(http::Router& router, Services& services, Endpoint endpoint, ReadyAnswer ready_answer) {
  auto path = endpoint.path;
  router.add({"GET", std::move(path), EndpointHandler(services, std::move(endpoint), std::move(ready_answer)), {}});
}

jobs::Computation computation_of(const http::Router& router, const store::JobRecord& job, store::StoredRequest stored,
                                 const Execution& execution) {
  http::Request request;
  request.method = std::move(stored.request.method);
  request.path = std::move(stored.request.path);
  request.query = std::move(stored.request.query);
  request.client = job.client;
  // The families of the owner are found by their names, while meshes may have lost it as an owner since.
  request.key = job.owner;
  request.is_admin = true;
  request.body = std::move(stored.body);
  request.headers = {{"Content-Type", std::move(stored.request.content_type)},
                     {"Accept", std::move(stored.request.accept)}};
  auto match = router.find(request.method, request.path);
  request.path_parameters = std::move(match.path_parameters);
  const auto* const handler = match.route->handler.target<EndpointHandler>();
  if (!handler) throw Error("job.interrupted", "The server stopped before the job had finished.");
  return handler->repeat(request, execution);
}

}  // namespace supple::routes
