#include <algorithm>

#include "handlers.h"
#include "supple/json/json_writer.h"
#include "supple/store/disk_space.h"

namespace supple::routes {
namespace {

constexpr unsigned char contract[] = {
#include "openapi_bytes.inc"
};
constexpr unsigned char accuracy_levels[] = {
#include "accuracy_levels_bytes.inc"
};

double uptime(const Services& services) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - services.started).count();
}

http::Response health(const Services& services) {
  json::JsonWriter out;
  out.begin_object().field("status", "ok").field("version", services.version).field("uptime_seconds", uptime(services));
  const auto load = services.load ? services.load() : http::Load{};
  out.field("silence_seconds", std::max(load.reader_silence_seconds, load.accept_silence_seconds)).end_object();
  return json_response(out.take());
}

/// The disk of the data folder. Throws "store.unavailable" if the database does not answer, "store.full" if nothing
/// more can be stored.
store::DiskSpace check_store(const Services& services) {
  services.store->jobs().job({});  // there is no such job, but only a database that answers knows
  const auto disk = store::disk_space(services.data);
  if (disk.free < services.limits.min_free) {
    constexpr int retry_after = 60;  // seconds: somebody has to make room
    const auto limit = static_cast<double>(services.limits.min_free);
    throw problem::ProblemError({"store.full",
                                 "The disk of the data folder has " + std::to_string(disk.free) +
                                     " bytes left, fewer than " + std::to_string(services.limits.min_free) +
                                     " (setting --min-free).",
                                 {},
                                 problem::Limit{limit, static_cast<double>(disk.free), "--min-free"},
                                 retry_after});
  }
  return disk;
}

http::Response readiness(const Services& services) {
  require_ready(services);
  if (services.draining) throw Error("server.shutting_down", "The server is about to shut down; ask another one.");
  const auto disk = check_store(services);
  json::JsonWriter out;
  out.begin_object()
      .field("status", "ready")
      .field("disk_free_bytes", disk.free)
      .field("meshes_loaded", services.meshes->size().meshes)
      .field("models_loaded", services.models->size())
      .field("models_damaged", services.models->damaged())
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
    snapshot.lobby_silence = load.reader_silence_seconds;
    snapshot.listener_silence = load.accept_silence_seconds;
  }
  if (services.memory) {
    snapshot.used_bytes = services.memory->used();
    snapshot.budget_bytes = services.memory->total();
  }
  snapshot.event_streams = services.event_streams;
  if (services.ready) {
    snapshot.jobs = {{"accepted", static_cast<std::int64_t>(services.jobs->waiting())},
                     {"running", static_cast<std::int64_t>(services.jobs->running())}};
    for (const auto priority : {Priority::interactive, Priority::normal, Priority::background})
      snapshot.waiting_jobs.emplace(priority_name(priority),
                                    static_cast<std::int64_t>(services.jobs->waiting(priority)));
    snapshot.computations = services.jobs->immediate();
    snapshot.abandoned = static_cast<std::int64_t>(services.jobs->abandoned());
    const auto size = services.meshes->size();
    snapshot.meshes_loaded = static_cast<std::int64_t>(size.meshes);
    snapshot.mesh_bytes = size.bytes;
    snapshot.models_loaded = static_cast<std::int64_t>(services.models->size());
    snapshot.models_damaged = static_cast<std::int64_t>(services.models->damaged());
    snapshot.disk_free_bytes = store::disk_space(services.data).free;
    const auto usage = services.store->usage();
    snapshot.store_bytes = {{"meshes", usage.meshes},
                            {"results", usage.results},
                            {"requests", usage.requests},
                            {"database", usage.database},
                            {"quarantine", usage.quarantine}};
    snapshot.store_limit = usage.limit;
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

http::Response accuracy_table() {
  return json_response(std::string(reinterpret_cast<const char*>(accuracy_levels), sizeof accuracy_levels));
}

}  // namespace

void add_service_routes(http::Router& router, Services& services) {
  const auto probe = [&](const char* path, http::Response (*answer)(const Services&), bool needs_no_key) {
    router.add({.method = "GET",
                .pattern = path,
                .handler = [&services, answer](const http::Request&) { return answer(services); },
                .body = {},
                .probe = true,
                .needs_no_key = needs_no_key});
  };
  probe("/healthz", health, true);
  probe("/readyz", readiness, true);
  probe("/metrics", metrics_text, false);
  router.add({.method = "GET",
              .pattern = "/openapi.yaml",
              .handler = [](const http::Request&) { return contract_text(); },
              .body = {},
              .needs_no_key = true});
  router.add({.method = "GET",
              .pattern = "/v1/accuracy-levels",
              .handler = [](const http::Request&) { return accuracy_table(); },
              .body = {}});
}

}  // namespace supple::routes
