#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

namespace supple::metrics {

/// Values that other rooms count. They are collected when the metrics are requested.
struct Snapshot {
  std::map<std::string, std::int64_t> jobs;          ///< number of unfinished jobs, by state
  std::map<std::string, std::int64_t> waiting_jobs;  ///< number of jobs that wait for a worker, by priority
  std::int64_t connections = 0;
  std::int64_t event_streams = 0;
  std::int64_t answering = 0;     ///< requests that are being answered, except probes
  std::int64_t evicted = 0;       ///< connections that have been closed to make room for others
  double lobby_silence = 0;       ///< seconds since the thread that reads requests last woke up
  double listener_silence = 0;    ///< seconds since the thread that accepts connections last woke up
  std::int64_t used_bytes = 0;    ///< bytes of the memory budget that requests and computations use
  std::int64_t budget_bytes = 0;  ///< limit of the memory budget
  std::int64_t computations = 0;  ///< immediate computations that run or wait
  std::int64_t abandoned = 0;     ///< computations that run on after a stop request
  std::int64_t meshes_loaded = 0;
  std::int64_t mesh_bytes = 0;  ///< estimated memory of the loaded meshes
  std::int64_t models_loaded = 0;
  std::int64_t models_damaged = 0;                  ///< model files that cannot be read
  std::int64_t disk_free_bytes = 0;                 ///< free space on the disk of the data folder
  std::map<std::string, std::int64_t> store_bytes;  ///< bytes of the data folder, by part
  std::int64_t store_limit = 0;                     ///< limit of their sum
};

/// The server's counters in the Prometheus text format. Any thread may call.
class Metrics {
 public:
  explicit Metrics(const std::string& version);
  ~Metrics();
  Metrics(const Metrics&) = delete;
  Metrics& operator=(const Metrics&) = delete;

  /// `route` is a pattern and not a path, so that the number of series is bounded; "" is reported as "none".
  void count_request(const std::string& route, const std::string& method, int status, double seconds);
  void count_finished_job(const std::string& kind, const std::string& state, double seconds);
  /// Records the time of a stage of an immediate answer: "read" (JSON and mesh), "wait" (for a slot) or "compute".
  void observe_stage(const std::string& stage, double seconds);
  /// Records the peak memory of a computation in bytes.
  void observe_memory(std::int64_t bytes);
  /// Counts states whose energy or stress a model has evaluated. `model` is the id of a loaded model, never a text from
  /// a request.
  void count_evaluations(const std::string& model, std::int64_t states);
  std::string text(const Snapshot& snapshot);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace supple::metrics
