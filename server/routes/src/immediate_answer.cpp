#include "immediate_answer.h"

#include <algorithm>
#include <cstdio>

namespace supple::routes {
namespace {

/// Where the time of an answer went, for a browser's tools and whoever else asks (W3C Server Timing).
std::string server_timing(double reading_seconds, const jobs::Profile& profile) {
  char text[160];
  std::snprintf(text, sizeof text, "read;dur=%.3f, wait;dur=%.3f, compute;dur=%.3f, memory;desc=\"%lld bytes\"",
                1e3 * reading_seconds, 1e3 * profile.waited, 1e3 * profile.computed,
                static_cast<long long>(profile.peak_memory));
  return text;
}

}  // namespace

http::Response response_of(store::Result result) {
  http::Response response;
  response.content_type = std::move(result.content_type);
  response.headers = std::move(result.headers);
  response.body = std::move(result.body);
  return response;
}

void leave_slot(const http::Request& request, Priority priority) {
  if (priority == Priority::background && request.stand_in) request.stand_in->wait_in_background();
}

store::Result compute_now(const Services& services, const http::Request& request, const jobs::Computation& computation,
                          jobs::Profile* profile) {
  jobs::Waiting waiting{[peer = request.peer] { return peer.hung_up(); }};
  if (auto* const stand_in = request.stand_in) {
    waiting.answer_for_it = [stand_in](const problem::Problem& problem, bool releases_slot) {
      stand_in->answer(problem, releases_slot);
    };
  }
  leave_slot(request, computation.priority);
  return services.jobs->run_now(computation, std::move(waiting), profile);
}

void work_now(const Services& services, const http::Request& request, jobs::Computation computation,
              const std::function<void(const Execution&)>& work) {
  computation.client = request.client;
  // It uses what is on the stack of this thread, which a computation on a background worker may outlive.
  computation.priority = std::min(computation.priority, Priority::normal);
  computation.run = [&](const Execution& execution) {
    work(execution);
    return store::Result{};
  };
  compute_now(services, request, computation);
}

http::Response answer_immediately(Services& services, const http::Request& request,
                                  const jobs::Computation& computation, double reading_seconds) {
  jobs::Profile profile;
  auto response = response_of(compute_now(services, request, computation, &profile));
  services.metrics->observe_stage("read", reading_seconds);
  services.metrics->observe_stage("wait", profile.waited);
  services.metrics->observe_stage("compute", profile.computed);
  services.metrics->observe_memory(profile.peak_memory);
  response.set_header("Server-Timing", server_timing(reading_seconds, profile));
  return response;
}

}  // namespace supple::routes
