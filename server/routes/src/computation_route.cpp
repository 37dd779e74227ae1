#include "computation_route.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "handlers.h"
#include "ownership.h"
#include "supple/routes/resume.h"

namespace supple::routes {
namespace {

std::string plain_seconds(double seconds) {
  auto text = std::to_string(seconds);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

http::Response accepted(const jobs::JobStatus& status) {
  auto response = json_response(write_job(status), 202);
  response.set_header("Location", "/v1/jobs/" + status.record.id);
  response.set_header("Retry-After", "1");
  return response;
}

http::Response finished(store::Result result) {
  http::Response response;
  response.content_type = std::move(result.content_type);
  response.headers = std::move(result.headers);
  response.body = std::move(result.body);
  return response;
}

/// When the handler on this thread began to read the body of its request.
struct Reading {
  const http::Request* request = nullptr;
  std::chrono::steady_clock::time_point begin;
};
thread_local Reading reading;

/// Where the computation of this thread's request goes instead of being answered, for a job that is made again.
struct Remaking {
  const Execution& execution;  ///< of the job
  std::optional<jobs::Computation> computation;
};
thread_local Remaking* remaking = nullptr;  // null where the request is to be answered

/// What a job of this request can be made again from.
jobs::RequestOfJob request_of_job(const http::Request& request) {
  return {{request.method, request.path, request.query, request.header("Content-Type"), request.header("Accept")},
          request.body};
}

/// What makes two requests of the same client one job: its header Idempotency-Key and what it asks for.
void identify(jobs::Computation& computation, const http::Request& request) {
  const auto key = request.header("Idempotency-Key");
  if (key.empty()) return;
  constexpr std::size_t longest = 255;
  const auto is_plain = [](char c) { return c > ' ' && c <= '~'; };
  if (key.size() > longest || !std::all_of(key.begin(), key.end(), is_plain)) {
    throw Error("request.invalid_parameter",
                "The header Idempotency-Key takes 1 to 255 printable ASCII characters without spaces.");
  }
  computation.idempotency_key = store::sha256(request.key + "\n" + key);
  std::string asked = request.method + " " + request.path + "\n";
  for (const auto& [name, value] : request.query) asked.append(name).append("=").append(value).append("\n");
  computation.request_hash = store::sha256(asked + store::sha256(request.body));
}

/// Seconds since the handler on this thread began to read the body; 0 where it has none.
double seconds_of_reading(const http::Request& request) {
  if (reading.request != &request) return 0;
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - reading.begin;
  return taken.count();
}

/// What the reading of the body has left of a deadline in seconds.
double rest_of_deadline(const http::Request& request, double deadline) {
  constexpr double least = 1e-3;  // it has passed, and is told so
  return std::max(least, deadline - seconds_of_reading(request));
}

/// Where the time of an answer went, for a browser's tools and whoever else asks (W3C Server Timing).
std::string server_timing(double reading_seconds, const jobs::Profile& profile) {
  char text[160];
  std::snprintf(text, sizeof text, "read;dur=%.3f, wait;dur=%.3f, compute;dur=%.3f, memory;desc=\"%lld bytes\"",
                1e3 * reading_seconds, 1e3 * profile.waited, 1e3 * profile.computed,
                static_cast<long long>(profile.peak_memory));
  return text;
}

}  // namespace

http::Response answer_computation(Services& services, const http::Request& request, jobs::Computation computation) {
  const auto preference = http::parse_preference(request.header("Prefer"), services.limits.max_wait);
  computation.client = request.client;
  computation.owner = request.key;
  computation.max_waiting = request.max_waiting_jobs;
  // Sessions of two keys that have the same name are two.
  if (!computation.session.empty() && !request.key.empty())
    computation.session = request.key + " " + computation.session;
  computation.bytes = static_cast<std::int64_t>(request.body.size());
  if (remaking) {
    remaking->computation = std::move(computation);
    return {};
  }
  if (!preference.respond_async && !preference.wait) {
    // The deadline of an immediate answer counts from the request's arrival: reading a large body takes its share of
    // it. The deadline of a job counts from its acceptance.
    computation.deadline = rest_of_deadline(request, computation.deadline);
    return answer_immediately(services, request, computation);
  }
  identify(computation, request);
  const auto hung_up = [peer = request.peer] { return peer.hung_up(); };
  http::Response response;
  if (preference.wait && *preference.wait > 0) {
    auto outcome =
        services.jobs->run_within(std::move(computation), *preference.wait, hung_up, request_of_job(request));
    response = outcome.result ? finished(std::move(*outcome.result)) : accepted(outcome.job);
    response.set_header("Preference-Applied", "wait=" + plain_seconds(*preference.wait));
  } else {
    response = accepted(services.jobs->submit(std::move(computation), request_of_job(request)));
    response.set_header("Preference-Applied", preference.respond_async ? "respond-async" : "wait=0");
  }
  return response;
}

http::Response answer_immediately(Services& services, const http::Request& request,
                                  const jobs::Computation& computation) {
  const double reading_seconds = seconds_of_reading(request);
  reading.request = nullptr;
  jobs::Profile profile;
  auto response = finished(compute_now(services, request, computation, &profile));
  services.metrics->observe_stage("read", reading_seconds);
  services.metrics->observe_stage("wait", profile.waited);
  services.metrics->observe_stage("compute", profile.computed);
  services.metrics->observe_memory(profile.peak_memory);
  response.set_header("Server-Timing", server_timing(reading_seconds, profile));
  return response;
}

store::Result compute_now(const Services& services, const http::Request& request, const jobs::Computation& computation,
                          jobs::Profile* profile) {
  jobs::Waiting waiting{[peer = request.peer] { return peer.hung_up(); }};
  if (auto* const stand_in = request.stand_in) {
    waiting.answer_for_it = [stand_in](const problem::Problem& problem, bool is_replaced) {
      stand_in->answer(problem, is_replaced);
    };
  }
  return services.jobs->run_now(computation, std::move(waiting), profile);
}

jobs::Computation computation_of(const http::Router& router, const store::JobRecord& job, store::StoredRequest stored,
                                 const Execution& execution) {
  http::Request request;
  request.method = std::move(stored.request.method);
  request.path = std::move(stored.request.path);
  request.query = std::move(stored.request.query);
  request.client = job.client;
  request.body = std::move(stored.body);
  request.headers = {{"Content-Type", std::move(stored.request.content_type)},
                     {"Accept", std::move(stored.request.accept)},
                     {"Prefer", "respond-async"}};
  auto match = router.find(request.method, request.path);
  request.path_parameters = std::move(match.path_parameters);
  Remaking made{execution, std::nullopt};
  remaking = &made;
  struct Forget {
    ~Forget() {
      remaking = nullptr;
      reading.request = nullptr;
    }
  } const forget;
  match.route->handler(request);
  if (!made.computation) throw Error("job.interrupted", "The server stopped before the job had finished.");
  return *std::move(made.computation);
}

std::shared_ptr<const store::LoadedMesh> load_mesh(const Services& services, const http::Request& request,
                                                   const std::string& id, double deadline) {
  require_mesh(services, request, id, "/mesh");
  try {
    if (auto mesh = services.meshes->find(id)) return mesh;
    if (remaking) return services.meshes->get(id, remaking->execution);
    std::shared_ptr<const store::LoadedMesh> mesh;
    jobs::Computation loading{"meshes", id, rest_of_deadline(request, deadline), {}};
    loading.client = request.client;
    loading.run = [&](const Execution& execution) {
      mesh = services.meshes->get(id, execution);
      return store::Result{};
    };
    compute_now(services, request, loading);
    return mesh;
  } catch (const Error& error) {
    if (error.code() != "mesh.not_found") throw;
    throw Error(error.code(), error.what(), {{"/mesh", error.what()}});
  }
}

const surface::NearestPointSearch& nearest_search(const Services& services, const http::Request& request,
                                                  const std::string& id, const store::LoadedMesh& mesh,
                                                  double deadline) {
  // Up to here it takes some milliseconds, for which no request waits until others have computed.
  constexpr std::int64_t max_faces_at_once = 20'000;
  if (remaking) return mesh.nearest(remaking->execution);
  if (!mesh.has_nearest() && mesh.mesh().face_count() > max_faces_at_once) {
    jobs::Computation making{"meshes", id, rest_of_deadline(request, deadline), {}};
    making.client = request.client;
    making.run = [&mesh](const Execution& execution) {
      mesh.nearest(execution);
      return store::Result{};
    };
    compute_now(services, request, making);
  }
  return mesh.nearest();
}

void tell_asked(const Execution& execution, std::string_view effect, bool asked) {
  if (execution.cost)
    execution.cost->add_effect(effect, asked, asked ? "the request asks for it" : "the request does not ask for it");
}

void tell_error_bars(const neural::Model& model, const Execution& execution) {
  const bool known = model.calibration.has_value();
  if (execution.cost)
    execution.cost->add_effect("error_bars", known,
                               known ? "the model knows by how much it errs" : "the model was not calibrated");
}

std::string plain_number(double value) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

const std::string& json_body(const http::Request& request) {
  reading = {&request, std::chrono::steady_clock::now()};
  const auto type = http::media_type(request.header("Content-Type"));
  if (type != "application/json") {
    // Without a type too: a page of another site may send such a request without asking.
    throw Error("http.unsupported_media_type", "This request takes a body of Content-Type application/json, not " +
                                                   (type.empty() ? "one without a type" : type.substr(0, 80)) + ".");
  }
  return request.body;
}

}  // namespace supple::routes
