#include "supple/metrics/metrics.h"

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>
#include <unistd.h>

#include <fstream>
#include <mutex>
#include <tuple>

namespace supple::metrics {
namespace {

/// Upper limits of the buckets in seconds, from far below the overhead of an immediate answer to a long job.
const prometheus::Histogram::BucketBoundaries latency_buckets{
    0.0001, 0.00025, 0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 5, 10, 60};

/// Upper limits of the buckets in bytes, from a small answer to the largest amount for one request.
const prometheus::Histogram::BucketBoundaries memory_buckets{1 << 20, 1 << 22, 1 << 24,  1 << 26,
                                                             1 << 28, 1 << 30, 1LL << 32};

double resident_bytes() {
  std::ifstream file("/proc/self/statm");
  double total = 0;
  double resident = 0;
  file >> total >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

}  // namespace

struct Metrics::Implementation {
  prometheus::Registry registry;
  prometheus::Family<prometheus::Counter>& requests = prometheus::BuildCounter()
                                                          .Name("supple_http_requests_total")
                                                          .Help("Answered requests by route, method and status.")
                                                          .Register(registry);
  prometheus::Family<prometheus::Histogram>& latency =
      prometheus::BuildHistogram()
          .Name("supple_http_request_duration_seconds")
          .Help("Time from a request's head to its answer, its body's transfer included.")
          .Register(registry);
  prometheus::Family<prometheus::Counter>& finished_jobs = prometheus::BuildCounter()
                                                               .Name("supple_jobs_finished_total")
                                                               .Help("Finished jobs by kind and state.")
                                                               .Register(registry);
  prometheus::Family<prometheus::Histogram>& job_seconds = prometheus::BuildHistogram()
                                                               .Name("supple_job_duration_seconds")
                                                               .Help("Time from a job's start to its end, by kind.")
                                                               .Register(registry);
  prometheus::Family<prometheus::Histogram>& stages =
      prometheus::BuildHistogram()
          .Name("supple_stage_duration_seconds")
          .Help("Time of immediate answers by stage: read, wait for a slot, compute.")
          .Register(registry);
  prometheus::Histogram& memory = prometheus::BuildHistogram()
                                      .Name("supple_computation_memory_bytes")
                                      .Help("The most memory that immediate computations held.")
                                      .Register(registry)
                                      .Add({}, memory_buckets);
  prometheus::Family<prometheus::Counter>& evaluations = prometheus::BuildCounter()
                                                             .Name("supple_model_evaluations_total")
                                                             .Help("States that neural models have given, by model.")
                                                             .Register(registry);
  prometheus::Family<prometheus::Gauge>& jobs =
      prometheus::BuildGauge().Name("supple_jobs").Help("Unfinished jobs by state.").Register(registry);
  prometheus::Family<prometheus::Gauge>& waiting_jobs = prometheus::BuildGauge()
                                                            .Name("supple_jobs_waiting")
                                                            .Help("Jobs that wait for a worker by priority.")
                                                            .Register(registry);
  prometheus::Gauge& connections = gauge("supple_connections", "Open connections.");
  prometheus::Gauge& event_streams = gauge("supple_event_streams", "Event streams that are followed.");
  prometheus::Gauge& answering = gauge("supple_requests_answering", "Requests that are answered, probes aside.");
  prometheus::Gauge& evicted =
      gauge("supple_connections_evicted", "Connections closed so far to make room for others.");
  prometheus::Gauge& lobby_silence = gauge("supple_lobby_silence_seconds",
                                           "Time since what arrives on connections was looked at: normally below 0.6.");
  prometheus::Gauge& listener_silence =
      gauge("supple_listener_silence_seconds", "Time since new connections were looked for: normally below 0.6.");
  prometheus::Gauge& used =
      gauge("supple_memory_used_bytes", "Memory that requests have reserved and computations have allocated.");
  prometheus::Gauge& budget = gauge("supple_memory_budget_bytes", "Memory that requests may reserve together.");
  prometheus::Gauge& computations = gauge("supple_immediate_computations", "Immediate computations that run or wait.");
  prometheus::Gauge& abandoned =
      gauge("supple_abandoned_computations",
            "Computations that run a second after their deadline or after their client has hung up.");
  prometheus::Gauge& meshes = gauge("supple_meshes_loaded", "Meshes held in memory.");
  prometheus::Gauge& mesh_bytes = gauge("supple_meshes_loaded_bytes", "Estimated memory of the meshes held.");
  prometheus::Gauge& models = gauge("supple_models_loaded", "Neural models that are served.");
  prometheus::Gauge& damaged_models = gauge("supple_models_damaged", "Model files that cannot be read.");
  prometheus::Gauge& disk_free = gauge("supple_disk_free_bytes", "Space left on the disk of the data folder.");
  prometheus::Family<prometheus::Gauge>& store =
      prometheus::BuildGauge().Name("supple_store_bytes").Help("Bytes of the data folder by part.").Register(registry);
  prometheus::Gauge& store_limit = gauge("supple_store_limit_bytes", "Bytes that the data folder may hold.");
  prometheus::Gauge& resident = gauge("process_resident_memory_bytes", "Resident memory of the process.");

  /// These maps cache the series in use, because the library finds a series by a slower search in a map of strings.
  std::mutex mutex;
  std::map<std::tuple<std::string, std::string, int>, prometheus::Counter*> request_series;
  std::map<std::string, prometheus::Histogram*> latency_series;

  prometheus::Gauge& gauge(const char* name, const char* help) {
    return prometheus::BuildGauge().Name(name).Help(help).Register(registry).Add({});
  }
};

Metrics::Metrics(const std::string& version) : implementation_(std::make_unique<Implementation>()) {
  prometheus::BuildGauge()
      .Name("supple_build_info")
      .Help("Always 1; the label is the version.")
      .Register(implementation_->registry)
      .Add({{"version", version}})
      .Set(1);
}
Metrics::~Metrics() = default;

void Metrics::count_request(const std::string& route, const std::string& method, int status, double seconds) {
  auto& self = *implementation_;
  const std::string& name = route.empty() ? "none" : route;
  // Without a route the method may be any text that a client sends. All such requests share one series.
  const std::string& label = route.empty() ? "any" : method;
  prometheus::Counter* counter = nullptr;
  prometheus::Histogram* histogram = nullptr;
  {
    const std::lock_guard lock(self.mutex);
    auto& cached_counter = self.request_series[{name, label, status}];
    if (!cached_counter) {
      cached_counter = &self.requests.Add({{"route", name}, {"method", label}, {"status", std::to_string(status)}});
    }
    counter = cached_counter;
    auto& cached_histogram = self.latency_series[name];
    if (!cached_histogram) cached_histogram = &self.latency.Add({{"route", name}}, latency_buckets);
    histogram = cached_histogram;
  }
  counter->Increment();
  histogram->Observe(seconds);
}

void Metrics::count_finished_job(const std::string& kind, const std::string& state, double seconds) {
  auto& self = *implementation_;
  self.finished_jobs.Add({{"kind", kind}, {"state", state}}).Increment();
  self.job_seconds.Add({{"kind", kind}}, latency_buckets).Observe(seconds);
}

void Metrics::observe_stage(const std::string& stage, double seconds) {
  implementation_->stages.Add({{"stage", stage}}, latency_buckets).Observe(seconds);
}

void Metrics::observe_memory(std::int64_t bytes) { implementation_->memory.Observe(static_cast<double>(bytes)); }

void Metrics::count_evaluations(const std::string& model, std::int64_t states) {
  implementation_->evaluations.Add({{"model", model}}).Increment(static_cast<double>(states));
}

std::string Metrics::text(const Snapshot& snapshot) {
  auto& self = *implementation_;
  for (const auto& [state, count] : snapshot.jobs) self.jobs.Add({{"state", state}}).Set(static_cast<double>(count));
  for (const auto& [priority, count] : snapshot.waiting_jobs)
    self.waiting_jobs.Add({{"priority", priority}}).Set(static_cast<double>(count));
  for (const auto& [part, bytes] : snapshot.store_bytes)
    self.store.Add({{"part", part}}).Set(static_cast<double>(bytes));
  self.store_limit.Set(static_cast<double>(snapshot.store_limit));
  self.connections.Set(static_cast<double>(snapshot.connections));
  self.event_streams.Set(static_cast<double>(snapshot.event_streams));
  self.answering.Set(static_cast<double>(snapshot.answering));
  self.evicted.Set(static_cast<double>(snapshot.evicted));
  self.lobby_silence.Set(snapshot.lobby_silence);
  self.listener_silence.Set(snapshot.listener_silence);
  self.used.Set(static_cast<double>(snapshot.used_bytes));
  self.budget.Set(static_cast<double>(snapshot.budget_bytes));
  self.computations.Set(static_cast<double>(snapshot.computations));
  self.abandoned.Set(static_cast<double>(snapshot.abandoned));
  self.meshes.Set(static_cast<double>(snapshot.meshes_loaded));
  self.mesh_bytes.Set(static_cast<double>(snapshot.mesh_bytes));
  self.damaged_models.Set(static_cast<double>(snapshot.models_damaged));
  self.disk_free.Set(static_cast<double>(snapshot.disk_free_bytes));
  self.models.Set(static_cast<double>(snapshot.models_loaded));
  self.resident.Set(resident_bytes());
  return prometheus::TextSerializer().Serialize(self.registry.Collect());
}

}  // namespace supple::metrics
