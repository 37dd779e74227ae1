#include "handlers.h"
#include "supple/json/json_writer.h"

namespace supple::routes {
namespace {

constexpr unsigned char contract[] = {
#include "openapi_bytes.inc"
};

double uptime(const Services& services) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - services.started).count();
}

http::Response health(const Services& services) {
  json::JsonWriter out;
  out.begin_object().field("status", "ok").field("version", services.version).field("uptime_seconds", uptime(services));
  out.end_object();
  return json_response(out.take());
}

http::Response readiness(const Services& services) {
  require_ready(services);
  json::JsonWriter out;
  out.begin_object()
      .field("status", "ready")
      .field("meshes_loaded", services.meshes->size().meshes)
      .field("models_loaded", services.models->size())
      .field("jobs_running", services.jobs->running())
      .field("jobs_waiting", services.jobs->waiting())
      .end_object();
  return json_response(out.take());
}

http::Response metrics_text(const Services& services) {
  metrics::Snapshot snapshot;
  if (services.load) {
    const auto load = services.load();
    snapshot.connections = load.connections;
    snapshot.answering = load.answering;
    snapshot.evicted = static_cast<std::int64_t>(load.evicted);
  }
  if (services.memory) {
    snapshot.used_bytes = services.memory->used();
    snapshot.budget_bytes = services.memory->total();
  }
  snapshot.event_streams = services.event_streams;
  if (services.ready) {
    snapshot.jobs = {{"accepted", static_cast<std::int64_t>(services.jobs->waiting())},
                     {"running", static_cast<std::int64_t>(services.jobs->running())}};
    snapshot.computations = services.jobs->immediate();
    const auto size = services.meshes->size();
    snapshot.meshes_loaded = static_cast<std::int64_t>(size.meshes);
    snapshot.mesh_bytes = size.bytes;
    snapshot.models_loaded = static_cast<std::int64_t>(services.models->size());
  }
  http::Response response;
  response.content_type = "text/plain; version=0.0.4; charset=utf-8";
  response.body = services.metrics->text(snapshot);
  return response;
}

http::Response contract_text() {
  http::Response response;
  response.content_type = "application/yaml";
  response.body.assign(reinterpret_cast<const char*>(contract), sizeof contract);
  return response;
}

}  // namespace

void add_service_routes(http::Router& router, Services& services) {
  router.add({"GET", "/healthz", [&services](const http::Request&) { return health(services); }, {}, true});
  router.add({"GET", "/readyz", [&services](const http::Request&) { return readiness(services); }, {}, true});
  router.add({"GET", "/metrics", [&services](const http::Request&) { return metrics_text(services); }, {}, true});
  router.add({"GET", "/openapi.yaml", [](const http::Request&) { return contract_text(); }, {}});
}

}  // namespace supple::routes
